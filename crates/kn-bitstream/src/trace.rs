//! The trace of syntax elements as they are read. `kn dump` prints it, and tests compare two
//! parsers by it.

/// Name of a syntax element with its array indices, as in `translation[4][2]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Name {
    text: &'static str,
    indices: [u32; 2],
    dimensions: u8,
}

impl Name {
    /// The name without indices.
    pub fn text(&self) -> &'static str {
        self.text
    }

    /// The indices, outermost first; at most two.
    pub fn indices(&self) -> &[u32] {
        &self.indices[..usize::from(self.dimensions)]
    }
}

impl From<&'static str> for Name {
    fn from(text: &'static str) -> Self {
        Self { text, indices: [0; 2], dimensions: 0 }
    }
}

impl From<(&'static str, u32)> for Name {
    fn from((text, index): (&'static str, u32)) -> Self {
        Self { text, indices: [index, 0], dimensions: 1 }
    }
}

impl From<(&'static str, u32, u32)> for Name {
    fn from((text, outer, inner): (&'static str, u32, u32)) -> Self {
        Self { text, indices: [outer, inner], dimensions: 2 }
    }
}

impl std::fmt::Display for Name {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.text)?;
        self.indices().iter().try_for_each(|index| write!(f, "[{index}]"))
    }
}

/// Value of a syntax element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'v> {
    /// `u(n)` with n < 32, `uleb`, `rice(k)`, `ue(k)`.
    Unsigned(u64),
    /// `u(32)` and `u(64)`: printed in hexadecimal.
    Word(u64),
    /// `srice(k)`, `huffman(t)`.
    Signed(i64),
    /// `f64`.
    Float(f64),
    /// `bytes(n)`.
    Bytes(&'v [u8]),
}

impl std::fmt::Display for Value<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unsigned(value) => write!(f, "{value}"),
            Self::Word(value) => write!(f, "0x{value:x}"),
            Self::Signed(value) => write!(f, "{value}"),
            // The shortest decimal that reads back to the same bits; what has none is given as
            // bits.
            Self::Float(value) if value.is_finite() => write!(f, "{value:?}"),
            Self::Float(value) => write!(f, "0x{:x}", value.to_bits()),
            Self::Bytes(bytes) => {
                f.write_str("x")?;
                bytes.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
            }
        }
    }
}

/// One syntax element of a stream.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element<'v> {
    /// Offset of its first bit, counted from where the reader counts.
    pub bit: u64,
    /// Its name.
    pub name: Name,
    /// Its value.
    pub value: Value<'v>,
}

/// A function that is called with every element as it is read.
pub type Trace<'t> = dyn FnMut(&Element<'_>) + 't;
