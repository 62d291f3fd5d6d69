//! Typed arrays in buffers. Everything is checked when an accessor is opened, so that reading it
//! cannot fail.

use super::super::{Fault, MeshErrorKind};
use super::bad;
use super::container::Buffer;
use super::json::{Root, Sparse as JsonSparse};
use super::views::View;

/// The document and its buffers, to open accessors in.
pub(super) struct Document {
    pub(super) root: Root,
    pub(super) buffers: Vec<Buffer>,
    /// One for each buffer view of the document.
    pub(super) views: Vec<View>,
}

/// Most numbers that one file may make us hold: accessors can share the same few bytes, and those
/// without data of their own cost a file nothing.
const MAX_NUMBERS: u64 = 1 << 28;

/// Count of the numbers in the accessors that are open so far.
#[derive(Default)]
pub(super) struct Budget {
    spent: u64,
}

impl Budget {
    pub(super) fn spend(&mut self, numbers: u64) -> Result<(), Fault> {
        self.spent = self.spent.saturating_add(numbers);
        if self.spent <= MAX_NUMBERS {
            return Ok(());
        }
        let what = "numbers in a glTF file";
        Err(MeshErrorKind::TooLarge { what, asked: self.spent, allowed: MAX_NUMBERS }.into())
    }
}

/// An array of vectors with `width` components each, in range of its buffers.
#[derive(Clone, Debug)]
pub(super) struct Accessor {
    /// The window of the elements; `None` where all are zero except the sparse ones.
    elements: Option<Window>,
    pub(super) count: usize,
    component: ComponentType,
    pub(super) width: usize,
    normalized: bool,
    sparse: Option<Sparse>,
}

/// Elements at `start + i · stride` of a buffer.
#[derive(Clone, Debug)]
struct Window {
    buffer: usize,
    start: usize,
    stride: usize,
}

/// Elements that replace those of the array: which, and by what.
#[derive(Clone, Debug)]
struct Sparse {
    count: usize,
    indices: Window,
    index_type: ComponentType,
    values: Window,
}

impl Accessor {
    /// Opens an accessor and checks that all of it lies inside its buffers.
    pub(super) fn open(document: &Document, at: usize, budget: &mut Budget) -> Result<Self, Fault> {
        let json = document.root.accessors.get(at);
        let json = json.ok_or_else(|| bad(format!("accessor {at} does not exist")))?;
        let (Some(component), Some(width)) =
            (ComponentType::of(json.component_type), width_of(&json.kind))
        else {
            return Err(bad(format!("accessor {at} has an unknown type")));
        };
        // An accessor without data of its own costs the file nothing.
        let price = if json.buffer_view.is_some() { 1 } else { 16 };
        budget.spend(json.count.saturating_mul(width as u64).saturating_mul(price))?;
        let size = width * component.size();
        let outside = || bad(format!("accessor {at} reaches outside its buffer"));
        let count = usize::try_from(json.count).map_err(|_| outside())?;
        let window = |view| document.window(view, json.byte_offset, count, size);
        let elements = match json.buffer_view {
            Some(view) => Some(window(view).ok_or_else(outside)?),
            None => None,
        };
        let sparse = match &json.sparse {
            Some(sparse) => Some(document.sparse(sparse, count, size).ok_or_else(outside)?),
            None => None,
        };
        Ok(Self { elements, count, component, width, normalized: json.normalized, sparse })
    }

    /// Opens an accessor that must have elements of `width` components.
    pub(super) fn open_wide(
        document: &Document,
        at: usize,
        width: usize,
        budget: &mut Budget,
    ) -> Result<Self, Fault> {
        let accessor = Self::open(document, at, budget)?;
        if accessor.width == width {
            Ok(accessor)
        } else {
            Err(bad(format!("accessor {at} should have {width} components")))
        }
    }

    /// All elements one after the other, `count × width`; integers scaled where they are
    /// normalised.
    pub(super) fn read(&self, document: &Document) -> Vec<f64> {
        let scale = match (self.normalized, self.component) {
            (true, ComponentType::I8) => 127.0,
            (true, ComponentType::U8) => 255.0,
            (true, ComponentType::I16) => 32767.0,
            (true, ComponentType::U16) => 65535.0,
            _ => 1.0,
        };
        // Signed normalised integers reach one step below −1, which means −1.
        let floor = if self.normalized { -1.0 } else { f64::NEG_INFINITY };
        let value = |raw: f64| if scale == 1.0 { raw } else { (raw / scale).max(floor) };
        self.raw(document, value)
    }

    /// All elements as vectors of three.
    pub(super) fn read_vectors(&self, document: &Document) -> Vec<[f64; 3]> {
        let values = self.read(document);
        values.chunks_exact(3).map(|vector| [vector[0], vector[1], vector[2]]).collect()
    }

    /// All components as the integers they are.
    pub(super) fn read_integers(&self, document: &Document) -> Vec<u32> {
        self.raw(document, |raw| raw as u32)
    }

    /// Whether the components are unsigned integers.
    pub(super) fn is_unsigned(&self) -> bool {
        matches!(self.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
    }

    fn raw<T: Copy + Default>(&self, document: &Document, convert: impl Fn(f64) -> T) -> Vec<T> {
        let width = self.width;
        let mut values = vec![T::default(); self.count * width];
        let step = self.component.size();
        if let Some(window) = &self.elements {
            let bytes = document.buffers[window.buffer].bytes();
            for (at, element) in values.chunks_exact_mut(width).enumerate() {
                let start = window.start + at * window.stride;
                for (axis, value) in element.iter_mut().enumerate() {
                    *value = convert(component(&bytes[start + axis * step..], self.component));
                }
            }
        }
        if let Some(sparse) = &self.sparse {
            let indices = document.buffers[sparse.indices.buffer].bytes();
            let bytes = document.buffers[sparse.values.buffer].bytes();
            for at in 0..sparse.count {
                let index = &indices[sparse.indices.start + at * sparse.indices.stride..];
                let element = component(index, sparse.index_type) as usize;
                let start = sparse.values.start + at * sparse.values.stride;
                for axis in 0..width {
                    let raw = component(&bytes[start + axis * step..], self.component);
                    values[element * width + axis] = convert(raw);
                }
            }
        }
        values
    }
}

impl Document {
    /// Elements of `size` bytes in a buffer view; `None` where they do not lie inside it.
    fn window(&self, view: usize, offset: u64, count: usize, size: usize) -> Option<Window> {
        let View { buffer, start, end: view_end, stride } = *self.views.get(view)?;
        let bytes = self.buffers.get(buffer)?.bytes();
        let start = start.checked_add(usize::try_from(offset).ok()?)?;
        let stride = stride.unwrap_or(size);
        if stride < size {
            return None;
        }
        let end = match count.checked_sub(1) {
            Some(last) => start.checked_add(last.checked_mul(stride)?)?.checked_add(size)?,
            None => start,
        };
        (end <= view_end && view_end <= bytes.len()).then_some(Window { buffer, start, stride })
    }

    /// Sparse elements whose indices are all below `count`.
    fn sparse(&self, json: &JsonSparse, count: usize, size: usize) -> Option<Sparse> {
        let index_type = ComponentType::of(json.indices.component_type)?;
        let replaced = usize::try_from(json.count).ok()?;
        let JsonSparse { indices, values, .. } = json;
        let indices =
            self.window(indices.buffer_view, indices.byte_offset, replaced, index_type.size())?;
        let values = self.window(values.buffer_view, values.byte_offset, replaced, size)?;
        let bytes = self.buffers[indices.buffer].bytes();
        let inside = (0..replaced).all(|at| {
            let index = component(&bytes[indices.start + at * indices.stride..], index_type);
            index < count as f64
        });
        inside.then_some(Sparse { count: replaced, indices, index_type, values })
    }
}

/// The type of a component.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ComponentType {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl ComponentType {
    /// The type of a number in the JSON.
    fn of(number: u32) -> Option<Self> {
        Some(match number {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    /// In bytes.
    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// Components of an element; smaller matrices occur in no mesh.
fn width_of(kind: &str) -> Option<usize> {
    Some(match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        _ => return None,
    })
}

/// The component at the start of `bytes`, which binary64 holds exactly whatever its type.
fn component(bytes: &[u8], kind: ComponentType) -> f64 {
    match kind {
        ComponentType::I8 => f64::from(bytes[0] as i8),
        ComponentType::U8 => f64::from(bytes[0]),
        ComponentType::I16 => f64::from(i16::from_le_bytes([bytes[0], bytes[1]])),
        ComponentType::U16 => f64::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        ComponentType::U32 => f64::from(u32::from_le_bytes(four(bytes))),
        ComponentType::F32 => f64::from(f32::from_le_bytes(four(bytes))),
    }
}

fn four(bytes: &[u8]) -> [u8; 4] {
    [bytes[0], bytes[1], bytes[2], bytes[3]]
}
