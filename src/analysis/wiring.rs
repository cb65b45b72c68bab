//! Voltages of the four wires of a sine/cosine signal against ground, named as in SICK 8010701: SIN, REFSIN, COS and
//! REFCOS. The sample times are stored elsewhere.

/// Voltages of the four wires. All columns have the same length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wires {
    pub sin_v: Vec<f64>,
    pub refsin_v: Vec<f64>,
    pub cos_v: Vec<f64>,
    pub refcos_v: Vec<f64>,
    /// Shaft angle from a reference encoder, in mechanical degrees from 0 to below 360. Empty without a reference.
    pub reference_deg: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire {
    Sin,
    Refsin,
    Cos,
    Refcos,
}

impl Wire {
    pub const ALL: [Wire; 4] = [Wire::Sin, Wire::Refsin, Wire::Cos, Wire::Refcos];

    /// Returns the name of the wire in the manual's spelling.
    pub const fn name(self) -> &'static str {
        match self {
            Wire::Sin => "SIN",
            Wire::Refsin => "REFSIN",
            Wire::Cos => "COS",
            Wire::Refcos => "REFCOS",
        }
    }
}

impl Wires {
    pub fn len(&self) -> usize {
        self.sin_v.len()
    }

    pub fn is_empty(&self) -> bool {
        self.sin_v.is_empty()
    }

    /// Returns SIN − REFSIN in volts, as seen by a differential receiver.
    pub fn sine_v(&self) -> Vec<f64> {
        difference(&self.sin_v, &self.refsin_v)
    }

    /// Returns COS − REFCOS in volts.
    pub fn cosine_v(&self) -> Vec<f64> {
        difference(&self.cos_v, &self.refcos_v)
    }
}

fn difference(wire: &[f64], reference: &[f64]) -> Vec<f64> {
    wire.iter().zip(reference).map(|(wire, reference)| wire - reference).collect()
}
