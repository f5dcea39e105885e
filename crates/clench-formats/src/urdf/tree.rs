//! Which link stands on which.

use crate::LoadError;
use crate::document::Element;
use std::collections::HashMap;

/// The link that is the world itself.
const WORLD: &str = "world";

/// The links and joints of a robot.
pub(super) struct Tree<'a> {
    links: Vec<&'a Element>,
    pub joints: Vec<Joint<'a>>,
    /// Links, each after the one that it stands on.
    order: Vec<usize>,
    /// The joint above each link.
    above: Vec<Option<usize>>,
    /// The body that each link is; 0 for the world.
    body: Vec<usize>,
}

/// A link and where it stands.
pub(super) struct Link<'a> {
    pub element: &'a Element,
    /// The body that it is; 0 for the world.
    pub body: usize,
    /// The body that it stands on: the world, where no joint says another.
    pub parent: usize,
}

/// A joint between two links.
pub(super) struct Joint<'a> {
    pub element: &'a Element,
    parent: usize,
    child: usize,
}

impl<'a> Tree<'a> {
    /// Reads which links there are, and which joints are between them.
    ///
    /// # Errors
    /// Links of one name; joints of links that are not there; a link below two joints, or below itself.
    pub(super) fn read(root: &'a Element) -> Result<Self, LoadError> {
        let links: Vec<&Element> = children(root, "link").collect();
        let mut names = HashMap::new();
        for (index, link) in links.iter().enumerate() {
            if names.insert(link.required_text("name")?, index).is_some() {
                return Err(link.error("this name is taken already"));
            }
        }
        let mut joints = Vec::new();
        let mut above: Vec<Option<usize>> = vec![None; links.len()];
        for element in children(root, "joint") {
            let joint = read_joint(element, &names).map_err(super::element::inside(element))?;
            let child = links[joint.child];
            if above[joint.child].is_some() {
                let message = format!("{} has a parent already", child.label());
                return Err(element.error(message));
            }
            if child.text("name") == Some(WORLD) {
                return Err(element.error("the link \"world\" is the world, which cannot move"));
            }
            above[joint.child] = Some(joints.len());
            joints.push(joint);
        }
        let order = parents_first(&joints, &above)?;
        let mut body = vec![0; links.len()];
        let bodies = order
            .iter()
            .filter(|&&link| links[link].text("name") != Some(WORLD));
        for (number, &link) in bodies.enumerate() {
            body[link] = number + 1;
        }
        Ok(Tree {
            links,
            joints,
            order,
            above,
            body,
        })
    }

    /// The links, each after the one that it stands on.
    pub(super) fn links(&self) -> impl Iterator<Item = Link<'a>> {
        self.order.iter().map(|&link| Link {
            element: self.links[link],
            body: self.body[link],
            parent: self.above[link].map_or(0, |joint| self.body[self.joints[joint].parent]),
        })
    }

    /// The body that a joint moves.
    pub(super) fn child(&self, joint: &Joint) -> usize {
        self.body[joint.child]
    }
}

fn children<'a>(root: &'a Element, tag: &'static str) -> impl Iterator<Item = &'a Element> {
    root.children.iter().filter(move |child| child.tag == tag)
}

fn read_joint<'a>(
    element: &'a Element,
    names: &HashMap<&str, usize>,
) -> Result<Joint<'a>, LoadError> {
    element.required_text("name")?;
    let link = |tag: &str| {
        let end = element.required_child(tag)?;
        let name = end.required_text("link")?;
        let found = names.get(name).copied();
        found.ok_or_else(|| end.error(format!("there is no link \"{name}\"")))
    };
    Ok(Joint {
        element,
        parent: link("parent")?,
        child: link("child")?,
    })
}

/// Links depth first: those without a parent in order of appearance, the children of each in the order of their joints.
///
/// # Errors
/// Joints that form a loop.
fn parents_first(joints: &[Joint], above: &[Option<usize>]) -> Result<Vec<usize>, LoadError> {
    let mut below = vec![Vec::new(); above.len()];
    for joint in joints {
        below[joint.parent].push(joint.child);
    }
    let mut pending: Vec<usize> = (0..above.len()).filter(|&l| above[l].is_none()).collect();
    pending.reverse();
    let mut order = Vec::with_capacity(above.len());
    while let Some(link) = pending.pop() {
        order.push(link);
        pending.extend(below[link].iter().rev());
    }
    let mut reached = vec![false; above.len()];
    order.iter().for_each(|&link| reached[link] = true);
    match joints.iter().find(|joint| !reached[joint.child]) {
        Some(joint) => Err(joint
            .element
            .error("this joint is part of a loop, or hangs on one")),
        None => Ok(order),
    }
}
