//! Links between a write and its undo.

use super::*;

/// Schema 5 is created with its original statements and rows. One row has yet to be sent to a server.
#[test]
fn schema_5_logbook_links_new_entries() {
    let (_root, path) = place();
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let old = Connection::open(&path).unwrap();
    for step in &schema::STEPS[..5] {
        old.execute_batch(step).unwrap();
    }
    old.execute_batch(
        r#"INSERT INTO server VALUES (1, 'plant', 0, 0);
           INSERT INTO event VALUES (1, 'aa', '2026-11-26T08:00:00Z', 'write', 'hiperface', '37h', '1', 0,
               'field:1@3+2: 00FF → C0FF', '[{"item":"field:1@3+2","old":"00FF","new":"C0FF"}]', 1, '/b.ron', 'bench 1',
               'user', '1.5.0', NULL);
           INSERT INTO result VALUES ('aa', '2026-11-26T08:00:01Z', 'done', NULL, 1);
           PRAGMA user_version = 5;"#,
    )
    .unwrap();
    drop(old);
    let mut logbook = Logbook::open(&path).unwrap();
    let write = logbook.entry(EntryId(1)).unwrap().unwrap();
    assert_eq!((&write.uid, write.undoes, write.undone_by), (&EntryUid("aa".to_owned()), None, None));
    assert_eq!(logbook.count_waiting(), Ok(1));
    let waiting = outbox::rows_to_send(&logbook.database, 9).unwrap();
    assert_eq!((waiting.events[0].undoes.as_deref(), waiting.results.len()), (None, 1));
    let undo = Intent { undoes: Some(write.uid), ..intent("field:1@3+2", 1, None) };
    let undo = logbook.record_intent(at(0), &device("1"), &undo).unwrap();
    logbook.record_outcome(undo, at(1), Outcome::Done, 1).unwrap();
    assert_eq!(logbook.entry(EntryId(1)).unwrap().unwrap().undone_by, Some(LinkedEntry { id: undo, at: at(0) }));
    let sent = outbox::rows_to_send(&logbook.database, 9).unwrap();
    assert_eq!(sent.events[1].undoes.as_deref(), Some("aa"), "other benches know it too");
}

#[test]
fn undo_links_to_entry_until_reverted() {
    let (_root, path) = place();
    let mut logbook = Logbook::open(&path).unwrap();
    let mut write = |second, undoes: Option<EntryId>, outcome| {
        let undoes = undoes.map(|id| logbook.entry(id).unwrap().unwrap().uid);
        let intent = Intent { undoes, ..intent("x", 1, None) };
        let id = logbook.record_intent(at(second), &device("1"), &intent).unwrap();
        logbook.record_outcome(id, at(second), outcome, 1).unwrap();
        id
    };
    let first = write(0, None, Outcome::Done);
    let broken_off = write(10, Some(first), Outcome::Failed("no reply".to_owned()));
    let undo = write(20, Some(first), Outcome::Done);
    let links = |logbook: &Logbook, id| {
        let Entry { undoes, undone_by, .. } = logbook.entry(id).unwrap().unwrap();
        (undoes.map(|link| link.id), undone_by.map(|link| link.id))
    };
    let found = Logbook::open(&path).unwrap();
    assert_eq!(links(&found, first), (None, Some(undo)), "not the one that failed");
    assert_eq!(links(&found, broken_off), (Some(first), None));
    assert_eq!(links(&found, undo), (Some(first), None));
    let redo = write(30, Some(undo), Outcome::Done);
    assert_eq!(links(&found, first), (None, None), "its values are back");
    assert_eq!(links(&found, undo), (Some(first), Some(redo)));
    write(40, Some(redo), Outcome::Done);
    assert_eq!(links(&found, first), (None, Some(undo)));
    let again = write(50, Some(first), Outcome::Done);
    assert_eq!(links(&found, first), (None, Some(again)));
    let listed = found.entries(&EntryFilter::default(), 10).unwrap();
    let of_first = listed.iter().find(|entry| entry.id == first).unwrap();
    assert_eq!(of_first.undone_by, Some(LinkedEntry { id: again, at: at(50) }));
}
