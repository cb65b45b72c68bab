//! Log entries about an encoder: its identity and link, the start of a write, and the results of operations.

use super::encoder::Encoder;
use crate::app::review::{ChangeDescription, OperationDescription};
use crate::app::services::Services;
use crate::app::{Severity, Text, explain};
use crate::bits::ByteOrder;
use crate::devices::biss::jobs::Prepared;
use crate::devices::biss::procedures::Identity;
use crate::devices::biss::procedures::procedure::Outcome;
use crate::devices::biss::profile::Op;
use crate::devices::biss::state::TEXTS;
use crate::devices::biss::state::explain as words;

impl Encoder {
    /// Logs the first reply on a newly opened link.
    pub(super) fn log_first_reply(&self, services: &mut Services) {
        let Some(identity) = self.identity() else { return };
        self.session.log_first_reply(vec![transport_text(identity), identity_text(identity)], services);
    }

    /// Logs the start of a write with the old and new value of each change.
    pub(super) fn log_operations(&self, what: &Text, prepared: &Prepared, services: &mut Services) {
        let identity = &prepared.identity;
        let operations = prepared.plan.ops.iter().flat_map(|op| match op {
            // Consecutive registers are represented by the first register only.
            Op::StoreData { .. } => {
                op.changed_items(&identity.description).iter().map(explain::literal_text).collect::<Vec<_>>()
            }
            op => {
                let OperationDescription { item, changes } = words::operation_texts(op, &identity.layout);
                changes.into_iter().map(|change| operation_text(&item, change)).collect()
            }
        });
        let text = Text::new("log.begins").with_text("what", what.clone()).with_list("operations", operations);
        services.log_without_display(Severity::Note, vec![text], Some(&self.session.name()));
    }

    pub(super) fn log_outcomes(&self, outcomes: &[Outcome], services: &mut Services) {
        for outcome in outcomes {
            services.log_without_display(Severity::Note, words::outcome_texts(outcome), Some(&self.session.name()));
        }
    }
}

/// Returns the log line for a changed value, with the old and the new value.
fn operation_text(item: &Text, ChangeDescription { part, old, new }: ChangeDescription) -> Text {
    let text = match part {
        None => TEXTS.text("log.operation"),
        Some(part) => TEXTS.text("log.operation_part").with_text("part", part),
    };
    text.with_text("item", item.clone()).with_text("old", old).with_text("new", new)
}

/// Returns the log line that states how the encoder is connected.
fn transport_text(identity: &Identity) -> Text {
    match (&identity.adapter, identity.order) {
        (Some(hello), _) => Text::new("log.adapter")
            .with("name", &hello.name)
            .with("firmware", &hello.firmware)
            .with("serial", &hello.serial),
        (None, Some(ByteOrder::HighFirst)) => TEXTS.text("log.high_first"),
        (None, _) => TEXTS.text("log.low_first"),
    }
}

fn identity_text(identity: &Identity) -> Text {
    let firmware = identity.firmware.map_or_else(|| Text::new("encoder_card.not_told"), explain::literal_text);
    TEXTS
        .text("log.identity")
        .with("profile", identity.kind.profile)
        .with_text("firmware", firmware)
        .with("multiturn", identity.layout.multiturn_bits())
        .with("singleturn", identity.layout.singleturn_bits())
}
