//! The kinematic tree of links.

use crate::document::Element;
use crate::error::LoadError;
use std::collections::HashMap;

/// The name of the link that is the world itself.
const WORLD: &str = "world";

/// The links and joints of a robot.
pub(super) struct Tree<'a> {
    links: Vec<&'a Element>,
    pub joints: Vec<Joint<'a>>,
    /// The links, each after its parent.
    order: Vec<usize>,
    /// The parent joint of each link.
    above: Vec<Option<usize>>,
    /// The body of each link; 0 for the world.
    body: Vec<usize>,
}

/// A link and its parent.
pub(super) struct Link<'a> {
    pub element: &'a Element,
    /// Its body; 0 for the world.
    pub body: usize,
    /// The parent body; the world if there is no parent joint.
    pub parent: usize,
}

/// A joint between two links.
pub(super) struct Joint<'a> {
    pub element: &'a Element,
    parent: usize,
    child: usize,
}

impl<'a> Tree<'a> {
    /// Reads the links, and the joints between them.
    ///
    /// # Errors
    /// Returns an error for links with the same name, joints of missing links, and a link below two joints or below
    /// itself.
    pub(super) fn read(root: &'a Element) -> Result<Self, LoadError> {
        let links: Vec<&Element> = children(root, "link").collect();
        let mut names = HashMap::new();
        for (index, link) in links.iter().enumerate() {
            if names.insert(link.required_text("name")?, index).is_some() {
                return Err(link.error("this name is already in use"));
            }
        }
        let mut joints = Vec::new();
        let mut above: Vec<Option<usize>> = vec![None; links.len()];
        for element in children(root, "joint") {
            let joint = read_joint(element, &names).map_err(super::element::inside(element))?;
            let child = links[joint.child];
            if above[joint.child].is_some() {
                let message = format!("{} already has a parent", child.label());
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

    /// Returns the links, each after its parent.
    pub(super) fn links(&self) -> impl Iterator<Item = Link<'a>> {
        self.order.iter().map(|&link| self.link(link))
    }

    /// Returns the links in the order of the file.
    pub(super) fn links_as_written(&self) -> impl Iterator<Item = Link<'a>> {
        (0..self.links.len()).map(|link| self.link(link))
    }

    fn link(&self, link: usize) -> Link<'a> {
        Link {
            element: self.links[link],
            body: self.body[link],
            parent: self.above[link].map_or(0, |joint| self.body[self.joints[joint].parent]),
        }
    }

    /// Returns the body that a joint moves.
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

/// Returns the links depth first: roots in order of appearance, children in the order of their joints.
///
/// # Errors
/// Returns an error if joints form a loop.
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
            .error("this joint is part of a loop, or below one")),
        None => Ok(order),
    }
}
