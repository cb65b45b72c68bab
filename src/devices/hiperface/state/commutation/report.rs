//! Report of a commutation procedure: the preparation, the readings and the results, one per line.

use super::{Commutation, EnergisedVector, PositionKind, RestReading, VectorSlot};
use crate::analysis::synchronise::Synchroniser;
use crate::app::Text;
use crate::app::report::SessionResult;
use crate::devices::hiperface::protocol::Geometry;
use crate::devices::hiperface::state::TEXTS;

impl Commutation {
    /// Returns the commutation results for an encoder report, or `None` before the first reading.
    pub fn session_result(&self, name: &str, geometry: Option<Geometry>) -> Option<SessionResult> {
        VectorSlot::ALL.into_iter().find_map(|slot| self.reading_at(slot))?;
        let mut texts = self.report_texts(name, geometry).into_iter();
        Some(SessionResult::Procedure { title: texts.next()?, lines: texts.collect() })
    }

    pub fn report_texts(&self, name: &str, geometry: Option<Geometry>) -> Vec<Text> {
        let form = &self.form;
        let mut lines = vec![TEXTS.text("commutation.report_title").with("name", name)];
        let ticks = [
            (form.disabled, "commutation.disabled"),
            (form.uncoupled, "commutation.uncoupled"),
            (form.released, "commutation.released"),
        ];
        let ticked: Vec<Text> = ticks.into_iter().filter(|(ticked, _)| *ticked).map(|(_, id)| TEXTS.text(id)).collect();
        if !ticked.is_empty() {
            lines.push(TEXTS.text("commutation.report_prepared").with_list("what", ticked));
        }
        if let Ok((current, time)) = form.limits() {
            let text = TEXTS.text("commutation.report_limits").with_number("current", current, 2);
            lines.push(text.with_number("time", time, 1));
        }
        if let Ok(degrees) = form.vector_deg() {
            lines.push(match form.vector {
                EnergisedVector::Other => TEXTS.text("commutation.report_angle").with_number("degrees", degrees, 1),
                named => TEXTS.text("commutation.report_vector").with_text("vector", TEXTS.text(named.keyword())),
            });
        }
        if let Ok(inputs) = form.inputs(geometry) {
            let direction = TEXTS.text(if inputs.reversed { "commutation.against" } else { "commutation.with" });
            let text = TEXTS.text("commutation.report_motor").with("pairs", inputs.pole_pairs);
            lines.push(text.with("periods", inputs.periods).with_text("direction", direction));
        }
        for slot in VectorSlot::ALL {
            if let Some(reading) = self.reading_at(slot) {
                let text = TEXTS.text("commutation.report_reading").with_text("slot", TEXTS.text(slot.keyword()));
                lines.push(
                    text.with_number("fine", reading.fine_periods, 5).with_text("kind", reading_kind_text(reading)),
                );
            }
        }
        if let Ok(offset) = self.offset(geometry) {
            if let Some(apart) = offset.apart_deg {
                lines.push(TEXTS.text("commutation.report_apart").with_number("apart", apart, 2));
            }
            let text = TEXTS.text("commutation.report_offset").with_number("degrees", offset.angle.to_degrees(), 4);
            lines.push(text.with("hex", format!("{:08X}", offset.angle.bits())));
        }
        lines.extend(self.second_vector_result(geometry).and_then(Result::ok).map(|(_, text)| text));
        lines
    }
}

pub fn reading_kind_text(reading: &RestReading) -> Text {
    match reading.kind {
        PositionKind::Fine { residual_periods, .. } => {
            let text = TEXTS.text("commutation.kind_fine").with("limit", Synchroniser::MAX_STEPS);
            text.with_number("residual", residual_periods * 32.0, 2)
        }
        PositionKind::Absolute => TEXTS.text("commutation.kind_absolute"),
        PositionKind::Typed => TEXTS.text("commutation.kind_typed"),
    }
}

impl VectorSlot {
    pub fn keyword(self) -> &'static str {
        match self {
            VectorSlot::OneSide => "commutation.one_side",
            VectorSlot::OtherSide => "commutation.other_side",
            VectorSlot::Second => "commutation.in_second",
        }
    }
}

impl EnergisedVector {
    pub const ALL: [EnergisedVector; 4] =
        [EnergisedVector::UAgainstBoth, EnergisedVector::UAgainstV, EnergisedVector::UAgainstW, EnergisedVector::Other];

    pub fn keyword(self) -> &'static str {
        match self {
            EnergisedVector::UAgainstBoth => "commutation.u_both",
            EnergisedVector::UAgainstV => "commutation.u_v",
            EnergisedVector::UAgainstW => "commutation.u_w",
            EnergisedVector::Other => "commutation.u_other",
        }
    }
}
