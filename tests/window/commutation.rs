//! Tests of the commutation assistant: requirements, readings, the offset, both ways to store it, and failures. The
//! expected numbers are from section 5 of the sine/cosine reference or were calculated separately.

use crate::tabs::Tabs as _;
use encoder_studio::analysis::quality::Verdict;
use encoder_studio::app::DeviceCommand;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, PendingEdits, Severity};
use encoder_studio::devices::hiperface::jobs::Change;
use encoder_studio::devices::hiperface::state::commutation::{
    CommutationAction as Assistant, EnergisedVector, Form, PositionKind, Source, Storage, VectorSlot,
};
use encoder_studio::devices::hiperface::state::{HiperfaceAction as Hiperface, ReviewState, commutation};

use crate::support::Desk;
use crate::texts;

/// A virtual SKM36 at rest, 100.75 periods from zero, with 128 periods per turn. Its sine and cosine counts are 409 and
/// 511.
const STATIONARY_ENCODER_QUERY: &str = "position=3224";

impl Desk {
    fn assist(&mut self, action: Assistant) {
        self.ask(Hiperface::Commutation(action));
    }

    fn edit(&mut self, change: impl FnOnce(&mut Form)) {
        let mut form = self.encoder().commutation.form.clone();
        change(&mut form);
        self.assist(Assistant::Edit(Box::new(form)));
    }

    /// Confirms all requirements and fills in the form for a motor with four pole pairs.
    fn prepare(&mut self) {
        self.edit(|form| {
            (form.disabled, form.uncoupled, form.released) = (true, true, true);
            (form.current_a, form.time_s) = ("2,5".to_owned(), "30".to_owned());
            form.pole_pairs = "4".to_owned();
        });
    }

    fn read(&mut self, slot: VectorSlot) {
        self.assist(Assistant::Read(slot));
        self.until("it is read", |studio| studio.hiperface().unwrap().commutation.pending_slot().is_none());
        self.until_ready();
    }

    fn type_in(&mut self, slot: VectorSlot, text: &str) {
        self.edit(|form| {
            let at = VectorSlot::ALL.iter().position(|own| *own == slot).unwrap();
            form.typed[at] = text.to_owned();
        });
        self.assist(Assistant::Use(slot));
    }

    fn why_not(&self) -> Option<&'static str> {
        let problem = self.encoder().commutation.problem.as_ref();
        problem.inspect(|text| texts::check(text)).map(|text| text.id())
    }

    fn offset(&self) -> Result<u32, &'static str> {
        let offset = self.encoder().commutation.offset(self.encoder().geometry());
        offset.map(|offset| offset.angle.bits()).map_err(|text| {
            texts::check(&text);
            text.id()
        })
    }

    fn second(&self) -> (Verdict, &'static str) {
        let second = self.encoder().commutation.second_vector_result(self.encoder().geometry()).expect("it was read");
        let (verdict, text) = second.unwrap();
        texts::check(&text);
        (verdict, text.id())
    }
}

#[test]
fn reads_nothing_before_checklist_is_complete() {
    let mut desk = Desk::new_form(STATIONARY_ENCODER_QUERY);
    let before = desk.wire().sent();
    for (change, why) in [
        ((|_| {}) as fn(&mut Form), "commutation.unprepared"),
        (|form| (form.disabled, form.uncoupled) = (true, true), "commutation.unprepared"),
        (|form| form.released = true, "entry.missing"),
        (|form| form.current_a = "NaN".to_owned(), "entry.number"),
        (|form| form.current_a = "0".to_owned(), "entry.number"),
        (|form| form.current_a = "2,5".to_owned(), "entry.missing"),
        (|form| (form.time_s, form.vector) = ("30".to_owned(), EnergisedVector::Other), "entry.missing"),
        (|form| form.vector_deg = "1e9".to_owned(), "entry.number"),
        (|form| (form.vector_deg, form.source) = ("15".to_owned(), Source::Typed), "entry.missing"),
        (|form| form.phase = "1".to_owned(), "entry.number"),
    ] {
        desk.edit(change);
        desk.assist(Assistant::Read(VectorSlot::OneSide));
        assert_eq!(desk.why_not(), Some(why));
    }
    assert_eq!(desk.wire().sent(), before, "the encoder was not asked");
    desk.edit(|form| form.phase = "0.75".to_owned());
    desk.read(VectorSlot::OneSide);
    assert_eq!(desk.why_not(), None);
}

#[test]
fn complete_run_stores_offset() {
    let mut desk = Desk::new_form(STATIONARY_ENCODER_QUERY);
    desk.prepare();
    // The readings take place while the position is polled.
    desk.command(DeviceCommand::Poll(Some(std::time::Duration::ZERO)));
    desk.read(VectorSlot::OneSide);
    let reading = *desk.encoder().commutation.reading_at(VectorSlot::OneSide).unwrap();
    // (409 − 511.5) · 5/1023 V and (511 − 511.5) · 5/1023 V give φ = 0.749 223 64. The middle of step 24 is 0.525 steps
    // further.
    assert!((reading.fine_periods - 100.749_223_64).abs() < 1e-8, "{reading:?}");
    let PositionKind::Fine { residual_periods, verdict: Verdict::Ok, .. } = reading.kind else { panic!("{reading:?}") };
    assert!((residual_periods * 32.0 - 0.524_844).abs() < 1e-6);
    assert_eq!(desk.offset(), Err("commutation.one_side_only"));
    desk.read(VectorSlot::OtherSide);
    assert!(desk.studio.is_live(), "polling goes on");
    desk.command(DeviceCommand::Poll(None));
    // frac(4 · 100.749 223 64 / 128) = 53.428 766° = 25FE 68F7h.
    assert_eq!(desk.offset(), Ok(0x25FE_68F7));
    // A quarter of an electrical turn is eight periods.
    desk.type_in(VectorSlot::Second, "108,75");
    assert_eq!(desk.second(), (Verdict::Ok, "commutation.fits"));

    desk.edit(|form| form.address = "16".to_owned());
    desk.assist(Assistant::Store);
    // The CRC was calculated with Python's `binascii.crc_hqx`.
    let record = [0x43, 0x4F, 0x31, 0x01, 0x25, 0xFE, 0x68, 0xF7, 4, 0, 0, 0, 0, 0, 0x29, 0x44];
    assert_eq!(desk.encoder().staged.edited_fields()[0].bytes.as_ref().unwrap()[16..32], record);
    assert_eq!(desk.notice_count("commutation.staged"), 1);
    assert_ne!(desk.wire().field(0)[16..32], record, "nothing is written before the review");
    let found = commutation::stored(&desk.encoder().staged);
    assert_eq!(found.iter().map(|own| (own.field, own.address, own.edited)).collect::<Vec<_>>(), [(0, 16, true)]);
    desk.write();
    assert_eq!(desk.wire().field(0)[16..32], record);
    let marks = desk.encoder().mounting_ranges(0);
    assert_eq!(marks, [(16..32, "commutation offset".to_owned())], "it belongs to the mounting");
    let found = commutation::stored(&desk.encoder().staged);
    assert!(!found[0].edited && found[0].record.unwrap().confirmed);
    // The readings are kept, so storing the same value again makes no edit.
    desk.assist(Assistant::Store);
    assert!(desk.edits().is_empty());
    assert_eq!(desk.notice_count("commutation.same"), 1);
    let report = desk.encoder().commutation.report_texts("x", desk.encoder().geometry());
    report.iter().for_each(texts::check);
    let english: Vec<String> = report.iter().map(encoder_studio::app::Text::terminal_text).collect();
    assert!(english.iter().any(|line| line == "Current limit: 2.50 A, time limit: 30.0 s"), "{english:?}");
    assert!(english.iter().any(|line| line == "Offset: 53.4288° el. = 25FE68F7h"), "{english:?}");
}

/// The user types a fine position of 339.02 with 1024 periods and 4 pole pairs (reference, section 5).
#[test]
fn typed_position_yields_reference_offset() {
    let mut desk = Desk::fresh("");
    desk.open("serial:/dev/nothing");
    desk.until("it is told", |studio| matches!(studio.hiperface().unwrap().session.phase, Phase::Lost(_)));
    assert_eq!(desk.offset(), Err("entry.missing"));
    desk.edit(|form| (form.pole_pairs, form.periods) = ("4".to_owned(), "1024".to_owned()));
    assert_eq!(desk.offset(), Err("commutation.no_reading"));
    desk.type_in(VectorSlot::OneSide, "339.02");
    assert_eq!(desk.offset(), Ok(0x5305_1EB8));
    // Reversed counting: 0.675 703 125 turns, ACFA E148h. With the vector at −30°, 1/12 turn more: 0.407 630 21.
    desk.edit(|form| form.reversed = true);
    assert_eq!(desk.offset(), Ok(0xACFA_E148));
    desk.edit(|form| (form.reversed, form.vector) = (false, EnergisedVector::UAgainstV));
    assert_eq!(desk.offset(), Ok(0x685A_740D));
    desk.edit(|form| form.vector = EnergisedVector::UAgainstBoth);
    for (pairs, periods) in [("0", "1024"), ("501", "1024"), ("NaN", "1024"), ("4", "0"), ("4", "65537"), ("4", "-1")] {
        desk.edit(|form| (form.pole_pairs, form.periods) = (pairs.to_owned(), periods.to_owned()));
        assert_eq!(desk.offset(), Err("entry.whole"), "{pairs} {periods}");
    }
    for text in ["NaN", "-1", "1e9", "134217729", "339.02.1"] {
        desk.type_in(VectorSlot::OneSide, text);
        assert_eq!(desk.why_not(), Some("entry.number"), "{text}");
    }
    desk.assist(Assistant::Read(VectorSlot::OneSide));
    assert!(desk.why_not().is_some());
    desk.assist(Assistant::Store);
    desk.assist(Assistant::Set);
    assert!(desk.edits().is_empty() && desk.encoder().session.review.is_none());
}

#[test]
fn rejects_positions_too_far_apart() {
    let mut desk = Desk::new_form("");
    desk.prepare();
    // Half a period is 1.40625° of the shaft at 128 periods per turn, and 5.625° electrical with four pole pairs.
    desk.type_in(VectorSlot::OneSide, "127.9");
    desk.type_in(VectorSlot::OtherSide, "0.4");
    assert_eq!(desk.offset(), Err("commutation.friction"));
    desk.assist(Assistant::Store);
    desk.assist(Assistant::Set);
    assert!(desk.edits().is_empty() && desk.encoder().session.review.is_none());
    desk.edit(|form| form.limit_deg = "5,7".to_owned());
    let offset = desk.encoder().commutation.offset(desk.encoder().geometry()).unwrap();
    assert!((offset.apart_deg.unwrap() - 5.625).abs() < 1e-9);
    assert!((offset.fine_periods - 0.15).abs() < 1e-9, "the mean the short way round");
    desk.edit(|form| form.limit_deg = "0".to_owned());
    assert_eq!(desk.offset(), Err("entry.number"));
}

#[test]
fn second_vector_reveals_wiring_faults() {
    let mut desk = Desk::new_form("");
    desk.prepare();
    desk.edit(|form| form.address = "0".to_owned());
    desk.type_in(VectorSlot::OneSide, "4");
    for (second, pairs, verdict, id) in [
        ("12", "4", Verdict::Ok, "commutation.fits"),
        // The path between both positions crosses the end of the revolution.
        ("124", "4", Verdict::Fault, "commutation.exchanged"),
        // 22.5° of the shaft are a quarter of an electrical turn with four pole pairs, whatever number was typed.
        ("12", "5", Verdict::Fault, "commutation.other_pairs"),
        ("124", "2", Verdict::Fault, "commutation.exchanged_pairs"),
        ("4.1", "4", Verdict::Fault, "commutation.still"),
        ("4", "4", Verdict::Fault, "commutation.still"),
        // A distance of 3.4 instead of 8 periods would mean 9.4 pole pairs.
        ("7.4", "4", Verdict::Fault, "commutation.unclear"),
        // The distance is more than an electrical turn.
        ("60", "4", Verdict::Fault, "commutation.unclear"),
    ] {
        desk.edit(|form| form.pole_pairs = pairs.to_owned());
        desk.type_in(VectorSlot::Second, second);
        assert_eq!(desk.second(), (verdict, id), "{second} {pairs}");
        desk.assist(Assistant::Store);
        let stored = !desk.edits().is_empty();
        assert_eq!(stored, verdict == Verdict::Ok, "what does not fit is not stored");
        assert_eq!(desk.why_not(), (!stored).then_some("commutation.second_refuses"));
        desk.command(DeviceCommand::RevertAll);
    }
    // With the opposite counting direction, exchanged phases are correct.
    desk.edit(|form| (form.pole_pairs, form.reversed) = ("4".to_owned(), true));
    desk.type_in(VectorSlot::Second, "124");
    assert_eq!(desk.second(), (Verdict::Ok, "commutation.fits"));
    desk.edit(|form| form.second_deg = "180".to_owned());
    let second = desk.encoder().commutation.second_vector_result(desk.encoder().geometry()).unwrap();
    assert_eq!(second.unwrap_err().id(), "entry.number");
}

#[test]
fn method_2_sets_position_in_phase() {
    let mut desk = Desk::new_form(STATIONARY_ENCODER_QUERY);
    desk.prepare();
    desk.read(VectorSlot::OneSide);
    desk.read(VectorSlot::OtherSide);
    desk.edit(|form| form.period = "3".to_owned());
    let setting = desk.encoder().commutation.setting(desk.encoder().geometry()).unwrap();
    // 3 · 32 + ⌊32 · 0.7492⌋ = 119. The remainder, 4 · 3.749 224 / 128 of a turn, is 42.178 766°.
    assert_eq!((setting.value, setting.exact, setting.verdict), (119, false, Verdict::Ok));
    assert!((setting.remaining_deg - 42.178_766).abs() < 1e-5, "{setting:?}");
    desk.assist(Assistant::Set);
    assert_eq!((desk.why_not(), desk.encoder().session.review.is_none()), (Some("commutation.needs_second"), true));
    desk.edit(|form| form.without_second = true);
    desk.assist(Assistant::Set);
    desk.until_planned();
    let ReviewState::Ready(prepared) = &desk.review().state else { panic!() };
    assert_eq!(prepared.wanted_position, Some(119), "the nearest that keeps the encoder's own five bits");
    desk.write_as_shown();
    desk.until_written();
    assert_eq!(desk.encoder().position_set, Some((3224, 120)));
    assert_eq!(desk.encoder().commutation.reading_at(VectorSlot::OneSide), None, "that was another zero");
    assert_eq!(desk.offset(), Err("commutation.no_reading"));
}

/// With 16 periods and 5 pole pairs, a step is 112.5° electrical. With 128 and 4, it is 14° (reference, section 5).
#[test]
fn method_2_rejects_large_step() {
    let mut desk = Desk::new_form(STATIONARY_ENCODER_QUERY);
    desk.prepare();
    desk.type_in(VectorSlot::OneSide, "3.47");
    for (periods, pairs, result) in [
        ("16", "5", Err("commutation.unusable")),
        ("16", "4", Err("commutation.unusable")),
        ("16", "3", Ok(Verdict::Warn)),
        ("128", "10", Ok(Verdict::Ok)),
        ("128", "11", Ok(Verdict::Warn)),
    ] {
        desk.edit(|form| (form.periods, form.pole_pairs) = (periods.to_owned(), pairs.to_owned()));
        let setting = desk.encoder().commutation.setting(desk.encoder().geometry());
        assert_eq!(setting.as_ref().map(|own| own.verdict).map_err(|text| text.id()), result, "{periods} {pairs}");
        // φ = 0.47: the lowest five bits are 15.
        assert!(setting.is_err() || setting.unwrap().value == 0x0F);
    }
    desk.edit(|form| (form.periods, form.pole_pairs) = ("16".to_owned(), "5".to_owned()));
    desk.assist(Assistant::Set);
    assert_eq!((desk.why_not(), desk.encoder().session.review.is_none()), (Some("commutation.unusable"), true));
    // The SKM36 has 128 periods and 4096 turns, which are 524 288 periods.
    desk.edit(|form| {
        (form.periods, form.pole_pairs, form.period) = (String::new(), "4".to_owned(), "524288".to_owned())
    });
    let setting = desk.encoder().commutation.setting(desk.encoder().geometry());
    assert_eq!(setting.unwrap_err().id(), "entry.whole");
    // In the second vector, the shaft is no longer at the position that was read.
    desk.edit(|form| form.period = "0".to_owned());
    desk.type_in(VectorSlot::Second, "11.47");
    let setting = desk.encoder().commutation.setting(desk.encoder().geometry());
    assert_eq!(setting.unwrap_err().id(), "commutation.not_there");
}

#[test]
fn rejects_moving_shaft_at_entry() {
    let mut desk = Desk::new_form("rpm=60");
    desk.prepare();
    desk.read(VectorSlot::OneSide);
    assert_eq!(desk.why_not(), Some("encoder.moving"));
    assert!(desk.encoder().commutation.reading_at(VectorSlot::OneSide).is_none());
    assert!(desk.notice_ids(Severity::Error).contains(&"encoder.moving"), "and stands in the log");
    desk.edit(|_| {});
    assert_eq!(desk.why_not(), None);
}

#[test]
fn reports_position_out_of_phase() {
    // The position word is shifted by exactly half a period against the sine and cosine signals.
    let mut desk = Desk::new_form("position=8");
    desk.prepare();
    for (shift, expected) in [(16, Some("commutation.far_apart")), (4, None), (-20, None)] {
        desk.ask(Hiperface::Plan(Change::ShiftPosition { steps: shift }));
        desk.until_planned();
        desk.write_as_shown();
        desk.until_written();
        desk.ask(Hiperface::CloseReview);
        desk.read(VectorSlot::OneSide);
        assert_eq!(desk.why_not(), expected, "{shift}");
        desk.assist(Assistant::Clear);
    }
    // A lag of 12 steps causes a warning because it exceeds 8/32 of a period. The position alone would not show it.
    desk.ask(Hiperface::Plan(Change::ShiftPosition { steps: 12 }));
    desk.until_planned();
    desk.write_as_shown();
    desk.until_written();
    desk.ask(Hiperface::CloseReview);
    desk.read(VectorSlot::OneSide);
    let kind = desk.encoder().commutation.reading_at(VectorSlot::OneSide).unwrap().kind;
    assert!(matches!(kind, PositionKind::Fine { verdict: Verdict::Warn, .. }), "{kind:?}");
    desk.edit(|form| form.source = Source::Absolute);
    desk.read(VectorSlot::OtherSide);
    let reading = desk.encoder().commutation.reading_at(VectorSlot::OtherSide).unwrap();
    assert_eq!((reading.fine_periods, reading.kind), (20.5 / 32.0, PositionKind::Absolute));
}

#[test]
fn readings_survive_lost_cable() {
    let mut desk = Desk::connected_at_port(STATIONARY_ENCODER_QUERY);
    desk.prepare();
    desk.read(VectorSlot::OneSide);
    desk.wire().unplug();
    desk.assist(Assistant::Read(VectorSlot::OtherSide));
    desk.until("it is lost", |studio| matches!(studio.hiperface().unwrap().session.phase, Phase::Lost(_)));
    assert_eq!(desk.encoder().commutation.pending_slot(), None);
    assert!(desk.encoder().commutation.reading_at(VectorSlot::OneSide).is_some());
    desk.assist(Assistant::Read(VectorSlot::OtherSide));
    assert_eq!(desk.why_not(), Some("commutation.not_ready"));
    desk.wire().plug();
    desk.command(DeviceCommand::Reconnect);
    desk.until_read();
    desk.read(VectorSlot::OtherSide);
    assert_eq!(desk.offset(), Ok(0x25FE_68F7));
    desk.wire().unplug();
    desk.until("it is lost", |studio| matches!(studio.hiperface().unwrap().session.phase, Phase::Lost(_)));
    desk.wire().plug();
    desk.wire().exchange("serial=ZZ1");
    desk.command(DeviceCommand::Reconnect);
    desk.until_read();
    assert_eq!(desk.encoder().commutation.form, Form::default(), "nothing of it is for this one");
    assert!(desk.encoder().commutation.reading_at(VectorSlot::OneSide).is_none());
}

#[test]
fn profile_saves_offset_as_mounting_value() {
    let mut desk = Desk::new_form("");
    let path = desk.outside.path("mine.ron");
    desk.ask(Hiperface::Save(path.clone()));
    desk.until("it is saved", |_| path.exists());
    desk.until_ready();
    desk.act(Action::Open(path.clone()));
    desk.until("it is open", |studio| studio.hiperface().unwrap().session.phase == Phase::Offline);
    desk.prepare();
    desk.edit(|form| form.without_second = true);
    desk.type_in(VectorSlot::OneSide, "339.02");
    desk.assist(Assistant::Store);
    assert_eq!(desk.why_not(), Some("commutation.no_room"), "the motor's data stay");
    assert!(desk.edits().is_empty());
    desk.edit(|form| (form.periods, form.address) = ("1024".to_owned(), "8".to_owned()));
    desk.assist(Assistant::Store);
    assert_eq!(desk.why_not(), Some("commutation.block"));
    desk.edit(|form| form.storage = Storage::Number);
    desk.assist(Assistant::Store);
    assert_eq!(desk.encoder().staged.edited_fields()[0].bytes.as_ref().unwrap()[8..12], [0x53, 0x05, 0x1E, 0xB8]);
    desk.command(DeviceCommand::RevertAll);
    desk.edit(|form| (form.storage, form.address, form.pole_pairs) = (Storage::Record, "0".into(), "256".into()));
    desk.assist(Assistant::Store);
    assert_eq!(desk.why_not(), Some("commutation.too_many_pairs"));
    desk.edit(|form| form.pole_pairs = "4".to_owned());
    desk.assist(Assistant::Store);
    let record = [0x43, 0x4F, 0x31, 0x00, 0x53, 0x05, 0x1E, 0xB8, 4, 0, 0, 0, 0, 0, 0x2A, 0x23];
    assert_eq!(desk.encoder().staged.edited_fields()[0].bytes.as_ref().unwrap()[..16], record);
    desk.ask(Hiperface::Save(path.clone()));
    desk.until("it is kept", |studio| !studio.hiperface().unwrap().staged.is_dirty());
    assert_eq!(desk.encoder().mounting_ranges(0), [(0..16, "commutation offset".to_owned())]);
    desk.edit(|form| form.address = "128".to_owned());
    desk.assist(Assistant::Store);
    assert_eq!(desk.why_not(), Some("entry.whole"));
    // The field has 32 bytes. The memory itself rejects this address, and the log reports it.
    desk.edit(|form| form.address = "112".to_owned());
    desk.assist(Assistant::Store);
    assert!(desk.edits().is_empty());
}

#[test]
fn linear_encoder_has_no_pole_pairs() {
    let mut desk = Desk::new_form("type=0x90");
    desk.prepare();
    desk.type_in(VectorSlot::OneSide, "3.5");
    assert_eq!(desk.offset(), Err("commutation.linear"));
}
