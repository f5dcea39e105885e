//! The records of MCAP files: a byte for the kind, the length of the content, and the content.

/// Kinds of records.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Header = 1,
    Footer = 2,
    Schema = 3,
    Channel = 4,
    Message = 5,
    Chunk = 6,
    MessageIndex = 7,
    ChunkIndex = 8,
    Statistics = 11,
    SummaryOffset = 14,
    DataEnd = 15,
}

/// A record under construction.
pub(super) struct Record(Vec<u8>);

impl Record {
    /// The size of the kind and the length, bytes.
    const START: usize = 9;

    pub(super) fn new(kind: Kind) -> Self {
        let mut bytes = vec![0; Self::START];
        bytes[0] = kind as u8;
        Record(bytes)
    }
    pub(super) fn raw(mut self, bytes: &[u8]) -> Self {
        self.0.extend_from_slice(bytes);
        self
    }
    pub(super) fn u16(self, number: u16) -> Self {
        self.raw(&number.to_le_bytes())
    }
    pub(super) fn u32(self, number: u32) -> Self {
        self.raw(&number.to_le_bytes())
    }
    pub(super) fn u64(self, number: u64) -> Self {
        self.raw(&number.to_le_bytes())
    }
    /// Appends bytes preceded by their length: text, a list or a map.
    pub(super) fn bytes(self, bytes: &[u8]) -> Self {
        self.u32(bytes.len() as u32).raw(bytes)
    }
    pub(super) fn text(self, text: &str) -> Self {
        self.bytes(text.as_bytes())
    }
    pub(super) fn times(self, [first, last]: [u64; 2]) -> Self {
        self.u64(first).u64(last)
    }
    pub(super) fn end(mut self) -> Vec<u8> {
        let length = (self.0.len() - Self::START) as u64;
        self.0[1..Self::START].copy_from_slice(&length.to_le_bytes());
        self.0
    }
}
