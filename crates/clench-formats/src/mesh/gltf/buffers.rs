//! The binary data of a glTF file: appended, embedded in its text, or in separate files.

use super::json::{Accessor, Primitive, Root};
use crate::base64;
use crate::mesh::MeshFolder;
use clench_math::Vec3;
use std::borrow::Cow;

/// The codes of the number types.
const U8: u32 = 5121;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// The bytes of all buffers.
pub(super) struct Buffers<'a> {
    root: &'a Root,
    bytes: Vec<Cow<'a, [u8]>>,
}

impl<'a> Buffers<'a> {
    /// # Errors
    /// Returns an error if bytes are missing or cannot be decoded.
    pub(super) fn new(
        root: &'a Root,
        binary: Option<&'a [u8]>,
        mesh_folder: &mut MeshFolder,
    ) -> Result<Self, String> {
        let mut bytes = Vec::with_capacity(root.buffers.len());
        for (number, buffer) in root.buffers.iter().enumerate() {
            let about = |error: String| format!("buffer {number}: {error}");
            bytes.push(match (&buffer.uri, binary) {
                (Some(uri), _) => Cow::Owned(fetch(uri, mesh_folder).map_err(about)?),
                (None, Some(binary)) if number == 0 => Cow::Borrowed(binary),
                (None, _) => return Err(about("has no data".to_owned())),
            });
        }
        Ok(Buffers { root, bytes })
    }

    /// Returns the vertices of an accessor.
    pub(super) fn positions(&self, accessor: usize) -> Result<Vec<Vec3<f64>>, String> {
        let accessor = self.accessor(accessor)?;
        if (accessor.component_type, accessor.kind.as_str()) != (F32, "VEC3") {
            return Err("positions that are not three numbers of single precision".to_owned());
        }
        let point = |bytes: &[u8]| {
            let (words, _) = bytes.as_chunks::<4>();
            Vec3::from_array([0, 1, 2].map(|k| f64::from(f32::from_le_bytes(words[k]))))
        };
        Ok(self.items(accessor, 12)?.map(point).collect())
    }

    /// Returns the corners of the triangles of a primitive with the given number of vertices. Without indices, these
    /// are the vertices in order.
    pub(super) fn corners(
        &self,
        primitive: &Primitive,
        vertices: usize,
    ) -> Result<Vec<[usize; 3]>, String> {
        let listed = match primitive.indices {
            Some(indices) => self.indices(indices)?,
            None => (0..vertices).collect(),
        };
        let count = listed.len();
        Ok(match primitive.mode() {
            4 => listed.as_chunks::<3>().0.to_vec(),
            // In a strip, every other triangle has reversed winding.
            5 => (listed.windows(3).enumerate())
                .map(|(k, corner)| match k % 2 {
                    0 => [corner[0], corner[1], corner[2]],
                    _ => [corner[1], corner[0], corner[2]],
                })
                .collect(),
            _ => (2..count)
                .map(|k| [listed[0], listed[k - 1], listed[k]])
                .collect(),
        })
    }

    fn indices(&self, accessor: usize) -> Result<Vec<usize>, String> {
        let accessor = self.accessor(accessor)?;
        let size = match (accessor.component_type, accessor.kind.as_str()) {
            (U8, "SCALAR") => 1,
            (U16, "SCALAR") => 2,
            (U32, "SCALAR") => 4,
            _ => return Err("indices that are not whole numbers of 8, 16 or 32 bits".to_owned()),
        };
        let number = |bytes: &[u8]| {
            let digits = bytes.iter().rev();
            digits.fold(0, |number, &byte| number << 8 | usize::from(byte))
        };
        Ok(self.items(accessor, size)?.map(number).collect())
    }

    fn accessor(&self, number: usize) -> Result<&'a Accessor, String> {
        let found = self.root.accessors.get(number);
        found.ok_or_else(|| format!("there is no accessor {number}"))
    }

    /// Returns the items of an accessor, of `size` bytes each.
    fn items(
        &self,
        accessor: &Accessor,
        size: usize,
    ) -> Result<impl Iterator<Item = &[u8]>, String> {
        if accessor.sparse.is_some() {
            return Err("sparse accessors are not supported".to_owned());
        }
        let view = accessor
            .buffer_view
            .ok_or("an accessor has no buffer view")?;
        let view = self.root.buffer_views.get(view);
        let view = view.ok_or("an accessor refers to a buffer view that does not exist")?;
        let bytes = self.bytes.get(view.buffer);
        let bytes = bytes.ok_or("a buffer view refers to a buffer that does not exist")?;
        let stride = view.byte_stride.unwrap_or(size).max(size);
        let viewed = (bytes.get(view.byte_offset..))
            .and_then(|rest| rest.get(..view.byte_length))
            .and_then(|rest| rest.get(accessor.byte_offset..));
        let viewed = viewed.ok_or("a buffer view extends beyond its buffer")?;
        let last = accessor.count.saturating_sub(1).checked_mul(stride);
        let needed = last.and_then(|last| last.checked_add(size));
        if accessor.count > 0 && needed.is_none_or(|needed| needed > viewed.len()) {
            return Err("an accessor extends beyond its buffer view".to_owned());
        }
        Ok((0..accessor.count).map(move |k| &viewed[k * stride..k * stride + size]))
    }
}

/// Returns the bytes of a URI: embedded in it or in the file that it names.
fn fetch(uri: &str, mesh_folder: &mut MeshFolder) -> Result<Vec<u8>, String> {
    let Some(data) = uri.strip_prefix("data:") else {
        return mesh_folder.read(&percent_decoded(uri));
    };
    let encoded = data.split_once(";base64,").map(|(_, encoded)| encoded);
    let encoded = encoded.ok_or("a data URI that is not in base64")?;
    base64::decode(encoded).map_err(|error| format!("not in base64: {error}"))
}

/// Decodes a file name in which `%20` stands for a space.
fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        let code = after.first_chunk::<2>().filter(|_| *first == b'%');
        let code = code.and_then(|digits| std::str::from_utf8(digits).ok());
        match code.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
