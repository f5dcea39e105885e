//! Height fields: from numbers and files, and invalid ones.

use crate::assets::*;
use clench_collide::ShapeKind;

#[test]
fn height_fields_come_from_numbers_and_files() {
    let folder = Folder::new("heights");
    let field = |attributes: &str| {
        let text = format!(
            "<mujoco>
               <compiler meshdir='parts'/>
               <asset><hfield {attributes} size='1 2 3 4'/></asset>
               <worldbody><geom type='hfield' hfield='h'/></worldbody>
             </mujoco>"
        );
        folder.load(&text)
    };
    let mut grid: Vec<u8> = [2i32, 3].iter().flat_map(|n| n.to_le_bytes()).collect();
    grid.extend(
        [4f32, 5.0, 6.0, 1.0, 2.0, 3.0]
            .iter()
            .flat_map(|x| x.to_le_bytes()),
    );
    folder.write("parts/h.bin", &grid);
    let mut image = Vec::new();
    let mut encoder = png::Encoder::new(&mut image, 3, 2);
    encoder.set_color(png::ColorType::Rgb);
    let pixels = [
        50, 0, 9, 100, 7, 7, 150, 1, 1, 200, 0, 0, 250, 0, 0, 255, 0, 0,
    ];
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&pixels)
        .unwrap();
    folder.write("parts/h.PNG", &image);
    for (attributes, expected) in [
        (
            "name='h' nrow='2' ncol='3' elevation='1 2 3 4 5 6'",
            [0.6, 0.8, 1.0, 0.0, 0.2, 0.4],
        ),
        ("file='h.bin'", [0.6, 0.8, 1.0, 0.0, 0.2, 0.4]),
        (
            "file='h.bin' nrow='7' ncol='-1' elevation='1' content_type=''",
            [0.6, 0.8, 1.0, 0.0, 0.2, 0.4],
        ),
        ("name='h' nrow='2' ncol='3'", [0.0; 6]),
        ("name='h' nrow='2' ncol='3' elevation=''", [0.0; 6]),
        (
            "name='h' nrow='2' ncol='3' elevation='0 1e-15 0 0 2e-15 0'",
            [0.0; 6],
        ),
        (
            "file='h.PNG'",
            [150.0, 200.0, 205.0, 0.0, 50.0, 100.0].map(|x| x / 205.0),
        ),
    ] {
        let model = field(attributes).unwrap_or_else(|error| panic!("{attributes}: {error}"));
        let shape = &model.height_fields[0].shape;
        assert_eq!((shape.rows(), shape.columns()), (2, 3));
        // Elevations are computed in single precision, as in MuJoCo's compiler.
        let expected = expected.map(|part: f32| f64::from(part));
        assert_eq!(shape.heights(), expected, "{attributes}");
        assert_eq!(model.geoms[0].kind, ShapeKind::HeightField);
        assert_eq!(model.params.geom_size[0].to_array(), [1.0, 2.0, 2.75]);
        assert!((model.params.geom_rbound[0] - 21f64.sqrt()).abs() < 1e-12);
    }
    grid.pop();
    folder.write("parts/short.bin", &grid);
    folder.write("parts/cut.png", &image[..image.len() - 20]);
    let mut claims = Vec::new();
    drop(png::Encoder::new(&mut claims, 50_000, 50_000).write_header());
    let header = 33;
    claims.splice(header.., image[header..].iter().copied());
    folder.write("parts/claims.png", &claims);
    for (attributes, complaint) in [
        ("name='h' nrow='2' ncol='3' elevation='1 2 3'", "2 x 3"),
        ("name='h' nrow='1' ncol='3'", "at least two"),
        ("name='h' nrow='2000000000' ncol='2000000000'", "bytes"),
        ("name='h' nrow='10000' ncol='10000'", "bytes"),
        ("name='h'", "nrow"),
        ("file='nowhere.png'", "nowhere.png"),
        ("name='h' file='short.bin'", "short.bin"),
        ("name='h' file='cut.png'", "cut.png"),
        (
            "name='h' file='claims.png'",
            "claims.png\": an image of 50000 x 50000",
        ),
        ("nrow='2' ncol='2'", "name"),
    ] {
        let error = field(attributes).expect_err(attributes);
        assert!(
            error.contains("model.xml:3: hfield") || error.contains("height field"),
            "{error}"
        );
        assert!(error.contains(complaint), "{attributes}: {error}");
    }
}
