//! Messages about sine/cosine captures: why a capture cannot be read or analysed, and which signals are faulty.

use std::path::Path;

use super::file_error_text;
use crate::analysis::capture::CaptureError;
use crate::analysis::diagnosis::{ComparisonObstacle, DiagnosisFinding, FindingKind, StuckLevel};
use crate::analysis::ellipse::{FitError, MIN_POINTS, SignalChannel};
use crate::analysis::nonlinearity::NonlinearityError;
use crate::analysis::quality::{QualityFinding as Parameter, Verdict};
use crate::analysis::revolution::RevolutionError;
use crate::analysis::signal_analysis::{AnalysisError, MIN_OCTANTS};
use crate::analysis::spectrum::SpectrumError;
use crate::app::Text;
use crate::app::number::decimal_places;
use crate::sim::sine_cosine::{Quantity, SettingError};
use crate::store::ReadCaptureError;

pub fn read_capture_error_text(path: &Path, error: &ReadCaptureError) -> Text {
    match error {
        ReadCaptureError::File(error) => file_error_text(error),
        ReadCaptureError::Capture(error) => capture_error_text(path, error),
        ReadCaptureError::Cancelled => Text::new("signal.cancelled").with("path", path.display()),
    }
}

fn capture_error_text(path: &Path, error: &CaptureError) -> Text {
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
        CaptureError::NotWhole { row, column, text: found } => {
            text("signal.not_whole").with("row", row).with("column", column).with("text", found)
        }
        CaptureError::NotFinite { row, column, text: found } => {
            text("signal.not_finite").with("row", row).with("column", column).with("text", found)
        }
        CaptureError::NoValues { skipped_rows, rows, row } => {
            text("signal.no_values").with("left_out", skipped_rows).with("rows", rows).with("row", row)
        }
        CaptureError::NoSampleClock { row } => text("signal.no_sample_clock").with("row", row),
        CaptureError::NotASampleNumber { row, column, text: found } => {
            text("signal.no_sample_number").with("row", row).with("column", column).with("text", found)
        }
        CaptureError::OpenQuote { row } => text("signal.open_quote").with("row", row),
    }
}

/// Returns the reason why samples cannot be analysed. `path` is their file.
pub fn analysis_error_text(path: &Path, error: &AnalysisError) -> Text {
    let text = |id| Text::new(id).with("path", path.display());
    match error {
        AnalysisError::Fit(error) => fit_error_text(path, error),
        AnalysisError::Coverage { octants } => {
            text("signal.coverage").with("octants", octants).with("least", MIN_OCTANTS)
        }
        AnalysisError::AtRest => text("signal.at_rest"),
        AnalysisError::NoSignal { share } => text("signal.no_signal").with_number("percent", share * 100.0, 0),
    }
}

fn fit_error_text(path: &Path, error: &FitError) -> Text {
    let text = |id| Text::new(id).with("path", path.display());
    match error {
        FitError::TooFew { points } => text("signal.few_points").with("points", points).with("least", MIN_POINTS),
        FitError::NotFinite { index } => text("signal.sample").with("number", index + 1),
        FitError::Constant => text("signal.constant"),
        FitError::Dead(SignalChannel::Sine) => text("signal.dead_sine"),
        FitError::Dead(SignalChannel::Cosine) => text("signal.dead_cosine"),
        FitError::Line => text("signal.line"),
        FitError::Ambiguous => text("signal.ambiguous"),
        FitError::NotAnEllipse => text("signal.no_ellipse"),
    }
}

pub fn spectrum_error_text(error: &SpectrumError) -> Text {
    match error {
        SpectrumError::TooFew { samples: 0 } => Text::new("spectrum.no_times"),
        SpectrumError::TooFew { samples } => Text::new("spectrum.few").with("samples", samples),
        SpectrumError::Uneven { index } => Text::new("spectrum.uneven").with("sample", index + 1),
        SpectrumError::NotFinite => Text::new("spectrum.not_finite"),
    }
}

/// Returns the reason why the deviation over one revolution cannot be determined from a reference encoder.
pub fn revolution_error_text(error: &RevolutionError) -> Text {
    match error {
        RevolutionError::Periods { found, given } => {
            Text::new("revolution.periods").with_number("found", *found, 1).with("given", given)
        }
        RevolutionError::Nonlinearity(NonlinearityError::NotMonotonic { index }) => {
            Text::new("revolution.turns_back").with("number", index + 1)
        }
        RevolutionError::Nonlinearity(NonlinearityError::TooLittle) => Text::new("revolution.too_little"),
        RevolutionError::Nonlinearity(NonlinearityError::NotFinite) => Text::new("revolution.no_number"),
    }
}

pub fn diagnosis_text(finding: &DiagnosisFinding) -> Text {
    let of = |id, which: SignalChannel| {
        Text::new(id).with_text(
            "channel",
            Text::new(match which {
                SignalChannel::Sine => "diagnosis.sine",
                SignalChannel::Cosine => "diagnosis.cosine",
            }),
        )
    };
    let millivolts = |id, volts: f64, share: f64| {
        Text::new(id).with_number("millivolts", volts * 1e3, 1).with_number("percent", share * 100.0, 1)
    };
    match finding.kind {
        FindingKind::Limit(parameter) => self::finding_text(&parameter),
        FindingKind::AtRest => Text::new("diagnosis.at_rest"),
        FindingKind::Still => Text::new("diagnosis.still"),
        FindingKind::Same => Text::new("diagnosis.same"),
        FindingKind::Dead { channel, stuck: StuckLevel::Together } => of("diagnosis.dead_together", channel),
        FindingKind::Dead { channel, stuck: StuckLevel::Ground(wire) } => {
            of("diagnosis.dead_ground", channel).with("wire", wire.name())
        }
        FindingKind::Dead { channel, stuck: StuckLevel::Supply(wire) } => {
            of("diagnosis.dead_supply", channel).with("wire", wire.name())
        }
        FindingKind::Dead { channel, stuck: StuckLevel::Apart(volts) } => {
            of("diagnosis.dead_apart", channel).with_number("volts", volts, 2)
        }
        FindingKind::Half { channel, share } => of("diagnosis.half", channel).with_number("percent", share * 100.0, 0),
        FindingKind::Level { wire, volts, ok_v: (least, most) } => Text::new("diagnosis.level")
            .with("wire", wire.name())
            .with_number("volts", volts, 2)
            .with_number("least", least, decimal_places(least).max(1))
            .with_number("most", most, decimal_places(most).max(1)),
        FindingKind::Hum { mains_hz, volts, share, common } => {
            let id = if common { "diagnosis.hum_common" } else { "diagnosis.hum" };
            millivolts(id, volts, share).with_number("hertz", mains_hz, 0)
        }
        FindingKind::Interference { frequency_hz, volts, share, common } => {
            let id = if common { "diagnosis.interference_common" } else { "diagnosis.interference" };
            with_frequency(millivolts(id, volts, share), frequency_hz)
        }
        FindingKind::Noise { volts, share } => millivolts("diagnosis.noise", volts, share),
        FindingKind::Harmonics { order, share } => Text::new("diagnosis.harmonics")
            .with("below", order - 1)
            .with("above", order + 1)
            .with_number("percent", share * 100.0, 1)
            .with_number("degrees", share.to_degrees(), 1),
        FindingKind::Clipping { channel, volts, samples } => {
            of("diagnosis.clipping", channel).with_number("volts", volts, 3).with_number("percent", samples * 100.0, 0)
        }
        FindingKind::Modulation { share } => Text::new("diagnosis.modulation").with_number("percent", share * 100.0, 1),
        FindingKind::Spikes { count, volts } => {
            Text::new("diagnosis.spikes").with("count", count).with_number("volts", volts, 2)
        }
        FindingKind::IntermittentContact { count, longest } => {
            Text::new("diagnosis.lets_go").with("count", count).with("longest", longest)
        }
        FindingKind::Missing { gaps, longest_s } => {
            Text::new("diagnosis.missing").with("count", gaps).with_number("longest", longest_s * 1e3, 3)
        }
        FindingKind::TimeGoesBack { sample } => Text::new("diagnosis.time_back").with("sample", sample + 1),
        FindingKind::Reversed { times } => Text::new("diagnosis.reversed").with("count", times),
        FindingKind::Coarse { step_deg } => Text::new("diagnosis.coarse")
            .with_number("degrees", step_deg, 0)
            .with_number("samples", 360.0 / step_deg, 1),
        FindingKind::Uncertain { share } => Text::new("diagnosis.uncertain")
            .with_number("percent", share * 100.0, 1)
            .with_number("degrees", share.to_degrees(), 1),
        FindingKind::HarmfulCorrection { raw_deg, corrected_deg } => Text::new("diagnosis.correction_harms")
            .with_number("raw", raw_deg, 2)
            .with_number("corrected", corrected_deg, 2),
        FindingKind::SingleEnded { sine_v, cosine_v } => {
            Text::new("diagnosis.single_ended").with_number("sine", sine_v, 2).with_number("cosine", cosine_v, 2)
        }
        FindingKind::NoiseIncreased { from_v, to_v } => {
            change_text("diagnosis.noise_rose", from_v * 1e3, to_v * 1e3, 1)
        }
        FindingKind::InterferenceIncreased { frequency_hz, from_v: 0.0, to_v, .. } => {
            with_frequency(Text::new("diagnosis.interference_new").with_number("to", to_v * 1e3, 1), frequency_hz)
        }
        FindingKind::InterferenceIncreased { frequency_hz, from_v, to_v, .. } => {
            with_frequency(change_text("diagnosis.interference_rose", from_v * 1e3, to_v * 1e3, 1), frequency_hz)
        }
        FindingKind::AmplitudeChanged { from_v, to_v } => {
            change_text("diagnosis.amplitude_changed", 2.0 * from_v, 2.0 * to_v, 3)
        }
    }
}

pub fn comparison_obstacle(obstacle: ComparisonObstacle) -> Text {
    Text::new(match obstacle {
        ComparisonObstacle::NoEllipseBefore => "compare.no_ellipse_before",
        ComparisonObstacle::NoEllipseAfter => "compare.no_ellipse_after",
        ComparisonObstacle::NoSpectrum => "compare.no_spectrum",
    })
}

fn with_frequency(text: Text, frequency_hz: f64) -> Text {
    // Above 1 kHz no decimals are shown, because the user expects a round number.
    text.with_number("hertz", frequency_hz, if frequency_hz < 1_000.0 { 1 } else { 0 })
}

fn change_text(id: &'static str, from: f64, to: f64, decimals: usize) -> Text {
    Text::new(id).with_number("from", from, decimals).with_number("to", to, decimals)
}

pub fn finding_text(finding: &Parameter) -> Text {
    let percent = |id, share: f64| Text::new(id).with_number("percent", share * 100.0, 1);
    match *finding {
        Parameter::Amplitude { volts, ok_v: (least, most), verdict } => {
            let id = if verdict == Verdict::Fault { "signal.amplitude_fault" } else { "signal.amplitude" };
            Text::new(id).with_number("volts", 2.0 * volts, 3).with_number("least", 2.0 * least, 1).with_number(
                "most",
                2.0 * most,
                1,
            )
        }
        Parameter::OffsetSine(share) => percent("signal.offset_sine", share),
        Parameter::OffsetCosine(share) => percent("signal.offset_cosine", share),
        Parameter::GainRatio(ratio) => Text::new("signal.gain").with_number("ratio", ratio, 3),
        Parameter::PhaseError(degrees) => Text::new("signal.phase").with_number("degrees", degrees, 2),
        Parameter::Residual(share) => percent("signal.residual", share),
    }
}

/// Returns the name of a setting of the virtual sine/cosine source, without its unit.
pub fn setting_name(quantity: Quantity) -> Text {
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

pub fn setting_value_error_text(error: &SettingError) -> Text {
    let SettingError { quantity: of, value, least, most } = *error;
    let id = if of == Quantity::Periods { "source.not_whole_in_range" } else { "source.out_of_range" };
    Text::new(id)
        .with_text("quantity", setting_name(of))
        .with_number("least", least, decimal_places(least))
        .with_number("most", most, decimal_places(most))
        .with("unit", format_args!("{}{}", if of.unit().is_empty() { "" } else { " " }, of.unit()))
        .with_number("value", value, decimal_places(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::diagnosis::Severity;
    use crate::analysis::wiring::Wire;
    use crate::app::Language;
    use crate::sim::sine_cosine::Settings;

    #[test]
    fn findings_name_remedies_in_both_languages() {
        let said = |what| {
            let finding = DiagnosisFinding { severity: Severity::Warning, kind: what };
            [Language::English, Language::German].map(|language| diagnosis_text(&finding).to_string_in(language))
        };
        let drive = FindingKind::Interference { frequency_hz: 8_000.3, volts: 0.0123, share: 0.0246, common: true };
        assert_eq!(
            said(drive),
            [
                "Both channels carry in-phase interference of 12.3 mV (2.5 % of the amplitude) at 8000 Hz, which is coupled in \
                 through the cable screen or the ground. Connect the cable screen at both ends.",
                "Beide Kanäle führen eine gleichphasige Störung von 12,3 mV (2,5 % der Amplitude) mit 8000 Hz, die über \
                 Schirm oder Masse eingekoppelt wird. Den Schirm beidseitig auflegen.",
            ]
        );
        let dead = FindingKind::Dead { channel: SignalChannel::Sine, stuck: StuckLevel::Ground(Wire::Refsin) };
        assert!(said(dead)[1].starts_with("Der Sinuskanal hat kein Signal, weil REFSIN auf Masse liegt."));
        let level = FindingKind::Level { wire: Wire::Refcos, volts: 3.2, ok_v: (2.375, 2.625) };
        assert!(said(level)[0].contains("3.20 V; the permitted range is 2.375 to 2.625 V"));
        let harmonics = FindingKind::Harmonics { order: 4, share: 0.02 };
        assert!(
            said(harmonics)[0]
                .starts_with("Harmonics 3 and 5 of the signal (2.0 %) cause an error of 1.1° within the signal period")
        );
    }

    #[test]
    fn rejected_setting_names_range() {
        let said = |quantity, value| {
            let error = Settings::default().with_value(quantity, value).validate().unwrap_err();
            [Language::English, Language::German]
                .map(|language| setting_value_error_text(&error).to_string_in(language))
        };
        assert_eq!(
            said(Quantity::GainRatio, 0.1234),
            [
                "Cosine-to-sine gain ratio: 0.123 is outside the range 0.2 to 5.",
                "Verstärkungsverhältnis Kosinus zu Sinus: 0,123 liegt außerhalb des Bereichs von 0,2 bis 5."
            ]
        );
        assert_eq!(
            said(Quantity::Amplitude, 3.0),
            ["Amplitude: 3 is outside the range 0 to 2 V.", "Amplitude: 3 liegt außerhalb des Bereichs von 0 bis 2 V."]
        );
        assert_eq!(
            said(Quantity::Periods, 16.5)[0],
            "Periods per revolution: 16.5 is not a whole number from 1 to 65536."
        );
    }
}
