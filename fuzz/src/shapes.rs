//! Files of meshes and height fields: each result is put into a scene with an object on it.

use crate::{checksums, files, trial};

/// Reads a mesh in binary or text STL.
pub fn stl(data: &[u8]) -> bool {
    mesh("stl", data)
}

/// Reads a mesh in OBJ.
pub fn obj(data: &[u8]) -> bool {
    mesh("obj", data)
}

/// Reads a mesh in MuJoCo's MSH.
pub fn msh(data: &[u8]) -> bool {
    mesh("msh", data)
}

/// Reads a mesh in Collada.
pub fn dae(data: &[u8]) -> bool {
    mesh("dae", data)
}

/// Reads a mesh in glTF, as a binary file or as text.
pub fn gltf(data: &[u8]) -> bool {
    mesh("gltf", data)
}

/// Reads a height field from an image, with corrected checksums: wrong ones would hide the readers behind them.
pub fn png(data: &[u8]) -> bool {
    height_field("png", &checksums::mend(data))
}

/// Reads a height field in MuJoCo's binary format.
pub fn grid(data: &[u8]) -> bool {
    height_field("bin", data)
}

fn mesh(extension: &str, data: &[u8]) -> bool {
    let file = files::write(&format!("mesh.{extension}"), data);
    load(&format!(
        "<mujoco>
           <asset>
             <mesh name='m' file='{file}'/>
           </asset>
           <worldbody>
             <geom type='plane' size='1 1 1'/>
             <body>
               <freejoint/>
               <geom type='mesh' mesh='m'/>
             </body>
             <body pos='.5 .5 .5'>
               <freejoint/>
               <geom size='.2'/>
             </body>
           </worldbody>
         </mujoco>",
        file = file.display()
    ))
}

fn height_field(extension: &str, data: &[u8]) -> bool {
    let file = files::write(&format!("heights.{extension}"), data);
    load(&format!(
        "<mujoco>
           <asset>
             <hfield name='h' file='{file}' size='1 1 .2 .1'/>
           </asset>
           <worldbody>
             <geom type='hfield' hfield='h'/>
             <body pos='0 0 .1'>
               <freejoint/>
               <geom type='box' size='.2 .1 .1'/>
             </body>
           </worldbody>
         </mujoco>",
        file = file.display()
    ))
}

fn load(text: &str) -> bool {
    clench::load_str_within(text, trial::budget())
        .map(trial::run)
        .is_ok()
}
