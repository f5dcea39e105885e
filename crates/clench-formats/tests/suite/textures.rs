//! Textures: the pixels are those of MuJoCo, and invalid files are reported.

use crate::pictures::png;
use clench_formats::Loader;
use clench_rigid::Model;
use clench_rigid::model::{Pixels, TextureKind};
use std::sync::Arc;

const R: [u8; 3] = [255, 0, 0];
const G: [u8; 3] = [0, 255, 0];
const B: [u8; 3] = [0, 0, 255];
const W: [u8; 3] = [255; 3];

fn load(texture: &str) -> Result<Model, String> {
    let files = [
        ("four.png", png([2, 2], &[R, G, B, W])),
        ("row.png", png([3, 1], &[R, G, B])),
        ("red.png", png([1, 1], &[R])),
        ("blue.png", png([1, 1], &[B])),
        ("cut.png", png([2, 2], &[R, G, B, W])[..40].to_vec()),
    ];
    let text =
        format!("<mujoco><compiler texturedir='pictures'/><asset>{texture}</asset></mujoco>");
    let loader = Loader::new().assets(files);
    loader.load_str(&text).map_err(|error| error.to_string())
}

fn pixels(texture: &str) -> Arc<Pixels> {
    load(texture).unwrap().visuals.textures[0].pixels()
}

/// Computes the FNV-1a hash (Fowler, Noll and Vo).
fn hash(bytes: &[u8]) -> u64 {
    let step = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}

#[test]
fn computed_pixels_are_those_of_mujoco() {
    // Hashes of `tex_data` in MuJoCo 4.0.0.
    let known = [
        ("2d", "gradient", "none", 0x3132_f461_ecbe_4725),
        ("2d", "gradient", "edge", 0xc7c5_86b0_91b3_8165),
        ("2d", "gradient", "cross", 0xef47_b022_42de_6fef),
        ("2d", "checker", "none", 0x13cc_4d79_0aba_7e6d),
        ("2d", "checker", "edge", 0x7aa2_3a9f_f923_58b5),
        ("2d", "checker", "cross", 0x8eb7_3d90_78ed_69b7),
        ("2d", "flat", "none", 0x11d6_c654_f335_e2c1),
        ("2d", "flat", "edge", 0xd94d_a646_0341_9771),
        ("2d", "flat", "cross", 0xc2ca_6093_cc8d_2f07),
        ("cube", "gradient", "none", 0x5b8e_42d0_b6e0_aef9),
        ("cube", "gradient", "edge", 0xf9c0_1885_102b_0381),
        ("cube", "gradient", "cross", 0xf741_9bb4_4ce8_196d),
        ("cube", "checker", "none", 0x92a3_55a3_287a_a925),
        ("cube", "checker", "edge", 0x8efd_caae_393b_4ca5),
        ("cube", "checker", "cross", 0x91a2_8226_fea2_e0d5),
        ("cube", "flat", "none", 0x999c_ef0a_6a4d_6569),
        ("cube", "flat", "edge", 0xc564_8ea1_db19_3889),
        ("cube", "flat", "cross", 0xef76_ce48_c3ac_fe1d),
    ];
    for (kind, builtin, mark, expected) in known {
        let found = pixels(&format!(
            "<texture name='t' type='{kind}' builtin='{builtin}' mark='{mark}' width='7' height='9' \
             rgb1='.1 .25 .7' rgb2='.9 .6 .33' markrgb='1 0 .5'/>"
        ));
        assert_eq!(hash(&found.rgb), expected, "{kind} {builtin} {mark}");
    }
}

#[test]
fn the_number_of_random_dots_matches_their_probability() {
    let found = pixels(
        "<texture name='t' type='2d' builtin='flat' mark='random' random='.1' rgb1='0 0 0' markrgb='1 1 1' \
         width='200' height='200'/>",
    );
    let dots = found.rgb.iter().filter(|&&part| part == 255).count() / 3;
    assert!((3600..4400).contains(&dots), "{dots}");
}

#[test]
fn files_are_read_turned_over_and_named() {
    let found = load("<texture type='2d' file='sub/four.png'/>").unwrap();
    let texture = &found.visuals.textures[0];
    assert_eq!(
        (&texture.name[..], texture.kind),
        ("four", TextureKind::Plane)
    );
    let read = |flip: &str| {
        pixels(&format!("<texture type='2d' file='four.png' {flip}/>"))
            .rgb
            .clone()
    };
    assert_eq!(read(""), [R, G, B, W].as_flattened());
    assert_eq!(read("hflip='true'"), [G, R, W, B].as_flattened());
    assert_eq!(read("vflip='true'"), [B, W, R, G].as_flattened());
}

#[test]
fn cubes_come_from_one_picture_a_grid_or_six_files() {
    let one = pixels("<texture name='t' file='four.png'/>");
    assert_eq!([one.width, one.height], [2, 2]);
    let grid =
        pixels("<texture name='t' file='row.png' gridsize='1 3' gridlayout='F.U' rgb1='1 1 1'/>");
    assert_eq!([grid.width, grid.height], [1, 6]);
    assert_eq!(grid.rgb, [W, W, B, W, R, W].as_flattened());
    let six = pixels("<texture name='t' fileleft='red.png' fileback='blue.png' rgb1='0 1 0'/>");
    assert_eq!(six.rgb, [G, R, G, G, G, B].as_flattened());
}

#[test]
fn invalid_textures_are_errors() {
    for (texture, words) in [
        (
            "<texture type='2d' name='t' file='no.png'/>",
            "pictures/no.png",
        ),
        (
            "<texture type='2d' name='t' file='cut.png'/>",
            "not a valid PNG image",
        ),
        ("<texture type='2d' name='t' file='four.bin'/>", "four.bin"),
        ("<texture type='2d' name='t'/>", "a builtin or a file"),
        ("<texture name='t'/>", "a cube texture needs"),
        (
            "<texture type='2d' builtin='flat' width='2' height='2'/>",
            "needs a name",
        ),
        (
            "<texture name='t' type='2d' builtin='flat' height='2'/>",
            "positive width",
        ),
        ("<texture name='t' builtin='flat' width='60000'/>", "bytes"),
        ("<texture name='t' file='row.png'/>", "squares"),
        (
            "<texture name='t' file='row.png' gridsize='1 3' gridlayout='RL'/>",
            "3 letters",
        ),
        (
            "<texture name='t' file='row.png' gridsize='1 3' gridlayout='RLX'/>",
            ".RLUDFB",
        ),
        (
            "<texture name='t' file='row.png' gridsize='5 3'/>",
            "12 squares",
        ),
        (
            "<texture name='t' fileup='row.png'/>",
            "squares of one size",
        ),
        (
            "<texture name='t' fileup='red.png' filedown='four.png'/>",
            "one size",
        ),
        (
            "<texture name='ab' builtin='flat' width='2'/><material name='m' texture='abc'/>",
            "\"abc\"",
        ),
    ] {
        let error = load(texture).err().unwrap_or_default();
        assert!(error.contains(words), "{texture}: {error}");
    }
    load("<texture type='skybox' builtin='gradient' width='4'/>").unwrap();
    // Discarded files are not read.
    let unread = "<mujoco><compiler discardvisual='true'/><asset><texture type='2d' name='t' file='no.png'/></asset></mujoco>";
    assert!(
        Loader::new()
            .load_str(unread)
            .unwrap()
            .visuals
            .textures
            .is_empty()
    );
}

/// Returns a pyramid with texture coordinates; the last corner of the last face has those in `last`.
fn pyramid(last: &str) -> String {
    format!(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt .1 .2\nvt .3 .4\nvt .5 .9\n\
         f 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 2/1 3/2 4/3\nf 1/3 4/2 3{last}\n"
    )
}

#[test]
fn corners_of_meshes_have_their_places_in_a_picture() {
    let load = |last: &str| {
        let text = "<mujoco><asset><mesh name='m' file='m.obj'/></asset>
            <worldbody><geom type='mesh' mesh='m'/></worldbody></mujoco>";
        let loader = Loader::new().assets([("m.obj", pyramid(last).into_bytes())]);
        loader.load_str(text).unwrap()
    };
    let model = load("/1");
    let mesh = &model.meshes[0];
    // In OBJ the vertical coordinate points up, in pictures down: MuJoCo's `mesh_texcoord` and `mesh_facetexcoord`.
    assert_eq!(mesh.texcoords, [[0.1, 0.8], [0.3, 0.6], [0.5, 1.0 - 0.9]]);
    assert_eq!(
        mesh.face_texcoords,
        [[0, 1, 2], [0, 1, 2], [0, 1, 2], [2, 1, 0]]
    );
    for unknown in ["", "/9"] {
        assert!(load(unknown).meshes[0].texcoords.is_empty(), "{unknown}");
    }
    let written = |texcoord: &str| {
        let mesh =
            format!("<mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1' texcoord='{texcoord}'/>");
        let geom = "<worldbody><geom type='mesh' mesh='m'/></worldbody>";
        Loader::new().load_str(&format!("<mujoco><asset>{mesh}</asset>{geom}</mujoco>"))
    };
    let model = written("0 0 1 0 0 1 1 1").unwrap();
    assert_eq!(model.meshes[0].texcoords[3], [1.0, 1.0]);
    assert_eq!(model.meshes[0].face_texcoords, model.meshes[0].faces);
    for (bad, words) in [
        ("0 0 1", "two numbers"),
        ("0 0 1 1", "do not match 4 vertices"),
    ] {
        let error = written(bad).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}
