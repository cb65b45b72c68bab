//! Families of encoders by the limits of their signals. SICK 8010701 (HIPERFACE) and the data sheets of AFS/AFM60 and TTK70;
//! section 1 of the project's sine/cosine reference.

use crate::app::Text;
use crate::signal::quality::Limits;

/// A family of encoders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Family {
    /// HIPERFACE: 0.9 … 1.1 V peak to peak.
    #[default]
    Hiperface,
    /// AFS60 and AFM60: 0.8 … 1.2 V peak to peak.
    AfsAfm60,
    /// TTK70: 0.9 … 1.1 V peak to peak.
    Ttk70,
}

impl Family {
    /// All of them.
    pub const ALL: [Family; 3] = [Family::Hiperface, Family::AfsAfm60, Family::Ttk70];

    /// Its limits.
    pub fn limits(self) -> Limits {
        match self {
            Family::Hiperface => Limits::HIPERFACE,
            Family::AfsAfm60 => Limits::AFS_AFM60,
            Family::Ttk70 => Limits::TTK70,
        }
    }

    /// Its name, with the amplitudes that are good.
    pub fn words(self) -> Text {
        let (least, most) = self.limits().ok_v;
        Text::new(match self {
            Family::Hiperface => "family.hiperface",
            Family::AfsAfm60 => "family.afs_afm60",
            Family::Ttk70 => "family.ttk70",
        })
        .with_number("least", 2.0 * least, 1)
        .with_number("most", 2.0 * most, 1)
    }
}
