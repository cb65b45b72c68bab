//! A capture of sine and cosine in words: why it cannot be read or analysed, and what is wrong with the signals.

use std::path::Path;

use super::file;
use crate::app::Text;
use crate::signal::analysis::{AnalysisError, LEAST_OCTANTS};
use crate::signal::capture::CaptureError;
use crate::signal::ellipse::{Channel, FitError, LEAST_POINTS};
use crate::signal::quality::{Finding, Verdict};
use crate::sim::sine_cosine::{Quantity, SettingError};
use crate::store::ReadCaptureError;

/// A file that could not be read as a capture.
pub fn read(path: &Path, error: &ReadCaptureError) -> Text {
    match error {
        ReadCaptureError::File(error) => file(error),
        ReadCaptureError::Capture(error) => capture(path, error),
        ReadCaptureError::Cancelled => Text::new("signal.cancelled").with("path", path.display()),
    }
}

fn capture(path: &Path, error: &CaptureError) -> Text {
    let text = |id| Text::new(id).with("path", path.display());
    match error {
        CaptureError::Empty => text("signal.empty"),
        CaptureError::NoNumbers => text("signal.no_numbers"),
        CaptureError::OneColumn => text("signal.one_column"),
        CaptureError::TooFewColumns { columns } => text("signal.few_columns").with("columns", columns),
        CaptureError::ShortRow { row, columns, needed } => {
            text("signal.short_row").with("row", row).with("columns", columns).with("needed", needed)
        }
        CaptureError::NotANumber { row, column, text: found } => {
            text("signal.not_a_number").with("row", row).with("column", column).with("text", format!("{found:?}"))
        }
        CaptureError::NotFinite { row, column, text: found } => {
            text("signal.not_finite").with("row", row).with("column", column).with("text", found)
        }
    }
}

/// Samples that cannot be analysed; `path` is where they came from.
pub fn analysis(path: &Path, error: &AnalysisError) -> Text {
    let text = |id| Text::new(id).with("path", path.display());
    match error {
        AnalysisError::Fit(error) => fit(path, error),
        AnalysisError::Coverage { octants } => {
            text("signal.coverage").with("octants", octants).with("least", LEAST_OCTANTS)
        }
        AnalysisError::NoSignal { share } => text("signal.no_signal").with_number("percent", share * 100.0, 0),
    }
}

fn fit(path: &Path, error: &FitError) -> Text {
    let text = |id| Text::new(id).with("path", path.display());
    match error {
        FitError::TooFew { points } => text("signal.few_points").with("points", points).with("least", LEAST_POINTS),
        FitError::NotFinite { index } => text("signal.sample").with("number", index + 1),
        FitError::Constant => text("signal.constant"),
        FitError::Dead(Channel::Sine) => text("signal.dead_sine"),
        FitError::Dead(Channel::Cosine) => text("signal.dead_cosine"),
        FitError::Line => text("signal.line"),
        FitError::Ambiguous => text("signal.ambiguous"),
        FitError::NotAnEllipse => text("signal.no_ellipse"),
    }
}

/// What of a signal is out of its limits.
pub fn finding(finding: &Finding) -> Text {
    let percent = |id, share: f64| Text::new(id).with_number("percent", share * 100.0, 1);
    match *finding {
        Finding::Amplitude { volts, ok_v: (least, most), verdict } => {
            let id = if verdict == Verdict::Fault { "signal.amplitude_fault" } else { "signal.amplitude" };
            Text::new(id).with_number("volts", 2.0 * volts, 3).with_number("least", 2.0 * least, 1).with_number(
                "most",
                2.0 * most,
                1,
            )
        }
        Finding::OffsetSine(share) => percent("signal.offset_sine", share),
        Finding::OffsetCosine(share) => percent("signal.offset_cosine", share),
        Finding::GainRatio(ratio) => Text::new("signal.gain").with_number("ratio", ratio, 3),
        Finding::PhaseError(degrees) => Text::new("signal.phase").with_number("degrees", degrees, 2),
        Finding::Residual(share) => percent("signal.residual", share),
    }
}

/// The name of a setting of the virtual sine/cosine source, without its unit.
pub fn quantity(quantity: Quantity) -> Text {
    Text::new(match quantity {
        Quantity::Periods => "source.periods",
        Quantity::Speed => "source.speed",
        Quantity::Rate => "source.rate",
        Quantity::Amplitude => "source.amplitude",
        Quantity::OffsetSine => "source.offset_sine",
        Quantity::OffsetCosine => "source.offset_cosine",
        Quantity::GainRatio => "source.gain_ratio",
        Quantity::PhaseError => "source.phase_error",
        Quantity::Level => "source.level",
        Quantity::ThirdHarmonic => "source.third_harmonic",
        Quantity::Modulation => "source.modulation",
        Quantity::Noise => "source.noise",
        Quantity::InterferenceFrequency => "source.interference_frequency",
        Quantity::Interference => "source.interference",
        Quantity::HumFrequency => "source.hum_frequency",
        Quantity::Hum => "source.hum",
        Quantity::Eccentricity => "source.eccentricity",
    })
}

/// A setting of the virtual source that is outside of its range.
pub fn setting(error: &SettingError) -> Text {
    let SettingError { quantity: of, value, least, most } = *error;
    let id = if of == Quantity::Periods { "source.not_whole_in_range" } else { "source.out_of_range" };
    // As many as it has, three at most.
    let whole = |value: f64, decimals: usize| (value * 10_f64.powi(decimals as i32)).fract() == 0.0;
    let decimals = |value: f64| (0..3).find(|decimals| whole(value, *decimals)).unwrap_or(3);
    Text::new(id)
        .with_text("quantity", quantity(of))
        .with_number("least", least, decimals(least))
        .with_number("most", most, decimals(most))
        .with("unit", format_args!("{}{}", if of.unit().is_empty() { "" } else { " " }, of.unit()))
        .with_number("value", value, decimals(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::sim::sine_cosine::Settings;

    #[test]
    fn a_setting_out_of_range_is_told_with_its_range() {
        let said = |quantity, value| {
            let error = Settings::default().with(quantity, value).checked().unwrap_err();
            [Language::English, Language::German].map(|language| setting(&error).words(language))
        };
        assert_eq!(
            said(Quantity::GainRatio, 0.1234),
            [
                "Gain ratio, cosine over sine: 0.123 is outside 0.2 … 5.",
                "Verstärkungsverhältnis Kosinus zu Sinus: 0,123 liegt außerhalb von 0,2 … 5."
            ]
        );
        assert_eq!(
            said(Quantity::Amplitude, 3.0),
            ["Amplitude: 3 is outside 0 … 2 V.", "Amplitude: 3 liegt außerhalb von 0 … 2 V."]
        );
        assert_eq!(
            said(Quantity::Periods, 16.5)[0],
            "Periods in a revolution: 16.5 is no whole number from 1 to 65536."
        );
    }
}
