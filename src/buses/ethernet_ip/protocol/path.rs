//! Path of a CIP request: segments for class, instance, attribute and connection point, of 8 or 16 bits (reference 7).

use super::fields::{FieldReader, PacketError, PacketField, Structure};

/// A path of segments, padded to whole words.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EPath(pub Vec<Segment>);

/// A segment of a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Segment {
    /// A logical segment.
    Logical {
        /// Kind of the segment.
        kind: LogicalKind,
        /// Value of the segment.
        number: u16,
        /// Width of the encoded value. Values above 255 always use the wide form.
        width: Width,
    },
    /// 34h: the electronic key of the required device.
    Key(ElectronicKey),
    /// 80h: data words for the addressed object, at most 255.
    Data(Vec<u16>),
    /// An unknown segment and all bytes after it. The length of the segment is unknown.
    Unknown(Vec<u8>),
}

/// The kind of a logical segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LogicalKind {
    /// Class, 20h.
    Class,
    /// Instance, 24h.
    Instance,
    /// Connection point, 2Ch.
    ConnectionPoint,
    /// Attribute, 30h.
    Attribute,
}

/// Encoded width of a logical value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Width {
    /// One byte after the segment type.
    Byte,
    /// A two-byte word, after a padding byte.
    Word,
}

/// The electronic key that a device compares before it opens a connection. A value of 0 matches any value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ElectronicKey {
    /// Vendor ID, as in the identity object.
    pub vendor: u16,
    /// Device type, as in the identity object.
    pub device_type: u16,
    /// Product code, as in the identity object.
    pub product_code: u16,
    /// Major revision. If bit 7 is set, compatible revisions are also accepted.
    pub major: u8,
    /// Minor revision.
    pub minor: u8,
}

const KINDS: [(u8, LogicalKind); 4] = [
    (0x20, LogicalKind::Class),
    (0x24, LogicalKind::Instance),
    (0x2C, LogicalKind::ConnectionPoint),
    (0x30, LogicalKind::Attribute),
];
/// First bytes of an electronic key: the segment type and the key format.
const KEY: [u8; 2] = [0x34, 0x04];
const DATA: u8 = 0x80;
const STRUCTURE: Structure = Structure::Path;

impl EPath {
    /// Creates the path to an object instance.
    pub fn to_instance(class: u16, instance: u16) -> Self {
        EPath(vec![Segment::new(LogicalKind::Class, class), Segment::new(LogicalKind::Instance, instance)])
    }

    /// Creates the path to an attribute of an object instance.
    pub fn to_attribute(class: u16, instance: u16, attribute: u16) -> Self {
        let EPath(mut segments) = EPath::to_instance(class, instance);
        segments.push(Segment::new(LogicalKind::Attribute, attribute));
        EPath(segments)
    }

    /// Creates the path to the assemblies of a cyclic connection. Their order is configuration, originator to target,
    /// and target to originator.
    pub fn to_assemblies(configuration: u16, to_target: u16, to_originator: u16) -> Self {
        const ASSEMBLY: u16 = 0x04;
        let EPath(mut segments) = EPath::to_instance(ASSEMBLY, configuration);
        segments.extend([to_target, to_originator].map(|point| Segment::new(LogicalKind::ConnectionPoint, point)));
        EPath(segments)
    }

    /// Returns the first logical value of the given kind.
    pub fn first_value(&self, wanted: LogicalKind) -> Option<u16> {
        self.values_of(wanted).next()
    }

    /// Returns all logical values of the given kind.
    pub fn values_of(&self, wanted: LogicalKind) -> impl Iterator<Item = u16> {
        self.0.iter().filter_map(move |segment| match segment {
            Segment::Logical { kind, number, .. } if *kind == wanted => Some(*number),
            _ => None,
        })
    }

    /// Parses a path that occupies all of `bytes`.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if a segment is incomplete.
    pub fn parse(bytes: &[u8]) -> Result<Self, PacketError> {
        let mut fields = FieldReader::new(STRUCTURE, bytes);
        let mut segments = Vec::new();
        while !fields.is_empty() {
            segments.push(Segment::take_from(&mut fields)?);
        }
        Ok(EPath(segments))
    }

    /// Returns the encoded path.
    pub fn emit(&self) -> Vec<u8> {
        self.0.iter().flat_map(Segment::emit).collect()
    }

    pub(super) fn take_from(fields: &mut FieldReader<'_>) -> Result<Self, PacketError> {
        let words = fields.u8()?;
        EPath::parse(fields.bytes(usize::from(words) * 2)?)
    }

    /// Appends the length in words and the path. A path longer than 255 words is truncated.
    pub(super) fn push_to(&self, bytes: &mut Vec<u8>) {
        let mut path = self.emit();
        path.truncate(usize::from(u8::MAX) * 2);
        // There are at most 255 words.
        bytes.push(path.len().div_ceil(2) as u8);
        let odd = path.len() % 2 == 1;
        bytes.extend(path);
        bytes.extend(odd.then_some(0));
    }
}

impl Segment {
    /// Creates a logical segment in its shortest form.
    pub const fn new(kind: LogicalKind, number: u16) -> Self {
        let width = if number > 0xFF { Width::Word } else { Width::Byte };
        Segment::Logical { kind, number, width }
    }

    fn take_from(fields: &mut FieldReader<'_>) -> Result<Self, PacketError> {
        let whole = fields.clone();
        let first = fields.u8()?;
        let wide = first & 1 == 1;
        let kind = KINDS.iter().find(|(code, _)| *code == first & !1).map(|(_, kind)| *kind);
        let segment = match (kind, first) {
            (Some(kind), _) if wide => match fields.u8()? {
                0 => Segment::Logical { kind, number: fields.u16()?, width: Width::Word },
                got => return Err(fields.value(PacketField::WidePrefix, got)),
            },
            (Some(kind), _) => Segment::Logical { kind, number: fields.u8()?.into(), width: Width::Byte },
            (None, first) if [first, fields.clone().u8().unwrap_or(0)] == KEY => {
                fields.u8()?;
                Segment::Key(ElectronicKey {
                    vendor: fields.u16()?,
                    device_type: fields.u16()?,
                    product_code: fields.u16()?,
                    major: fields.u8()?,
                    minor: fields.u8()?,
                })
            }
            (None, DATA) => {
                let words = fields.u8()?;
                Segment::Data((0..words).map(|_| fields.u16()).collect::<Result<_, _>>()?)
            }
            (None, _) => {
                *fields = whole;
                Segment::Unknown(fields.take_rest().to_vec())
            }
        };
        Ok(segment)
    }

    fn emit(&self) -> Vec<u8> {
        match self {
            Segment::Logical { kind, number, width } => {
                let code = KINDS.iter().find(|(_, known)| known == kind).map_or(0, |(code, _)| *code);
                let [low, high] = number.to_le_bytes();
                match (width, high) {
                    (Width::Byte, 0) => vec![code, low],
                    _ => vec![code | 1, 0, low, high],
                }
            }
            Segment::Key(key) => {
                let mut bytes = KEY.to_vec();
                bytes.extend([key.vendor, key.device_type, key.product_code].into_iter().flat_map(u16::to_le_bytes));
                bytes.extend([key.major, key.minor]);
                bytes
            }
            Segment::Data(words) => {
                let words = words.get(..usize::from(u8::MAX)).unwrap_or(words);
                // There are at most 255 words.
                let mut bytes = vec![DATA, words.len() as u8];
                bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
                bytes
            }
            Segment::Unknown(bytes) => bytes.clone(),
        }
    }
}
