//! Copies rows between the local file and the server in both directions. The local file is always complete, because
//! rows are recorded there first and rows from other computers are copied to it. Reading therefore never waits for the
//! server.
//!
//! A row that was sent twice, because the connection was lost before the reply, is ignored the second time: its `uid`
//! is unique. Rows are sent in the order in which they were recorded.
//!
//! What was received or sent is kept if a later request fails. The first requests are small, so that a slow network makes
//! progress, too.

use std::path::Path;
use std::time::{Duration, Instant};

use tokio_postgres::{Client as Postgres, GenericClient, IsolationLevel, Row};

use super::super::outbox::{self, EventRow, Mark, Marks, ResultRow, Rows};
use super::super::{LogbookErrorKind, schema as local_schema};
use super::client::Client;
use super::error::ServerErrorKind;
use super::schema;
use crate::store::logbook::LOCK_TIMEOUT;

/// Number of rows in the first request of a transfer. After each quick request, the number is doubled.
const FIRST: usize = 100;
const QUICK: Duration = Duration::from_millis(300);
/// Maximum number of rows received in one request.
const RECEIVED: usize = 5_000;
/// Maximum number of rows sent in one transaction, during which other computers wait.
const SENT: usize = 1_000;

/// Number of rows that were copied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Transferred {
    /// Events and results that were not in the local file yet.
    pub received: usize,
    /// Events and results that were sent.
    pub sent: usize,
}

/// Copies all rows that are missing on either side.
pub(super) fn transfer(client: &mut Client, identity: &str, path: &Path) -> Result<Transferred, ServerErrorKind> {
    let local = |problem: LogbookErrorKind| ServerErrorKind::Local(problem.into_error(path));
    let sqlite = |error: rusqlite::Error| local(error.into());
    let mut database = local_schema::open(path, client.time_left().min(LOCK_TIMEOUT)).map_err(local)?;
    let known = outbox::marks(&database, identity).map_err(sqlite)?;
    let mut marks = match known {
        Some(marks) if client.run(async |postgres| has_rows(postgres, &marks).await)? => marks,
        _ => {
            outbox::begin(&mut database, identity).map_err(sqlite)?;
            Marks::default()
        }
    };
    let (mut done, mut size) = (Transferred::default(), FIRST);
    loop {
        let began = Instant::now();
        let waiting = outbox::rows_to_send(&database, size.min(SENT)).map_err(sqlite)?;
        let (rows, after) = client.run(async |postgres| {
            if waiting.is_empty() {
                receive(postgres, &marks, size).await
            } else {
                send(postgres, &waiting, &marks, size).await
            }
        })?;
        let adopted = outbox::adopt(&mut database, identity, &rows, &waiting, [&marks, &after]).map_err(sqlite)?;
        done.received += adopted.ok_or(ServerErrorKind::OtherServer)?;
        marks = after;
        done.sent += waiting.events.len() + waiting.results.len();
        if waiting.is_empty() && rows.largest_count() < size {
            return Ok(done);
        }
        if began.elapsed() < QUICK {
            size = (2 * size).min(RECEIVED);
        }
    }
}

/// Returns whether the rows at the marks are still on the server.
async fn has_rows(client: &impl GenericClient, marks: &Marks) -> Result<bool, ServerErrorKind> {
    let sql = "SELECT (SELECT uid FROM event WHERE id = $1), (SELECT event FROM result WHERE id = $2)";
    let row = client.query_one(sql, &[&marks.event.number, &marks.result.number]).await?;
    let is_there = |mark: &Mark, found: Option<String>| mark.number == 0 || found.as_ref() == Some(&mark.uid);
    Ok(is_there(&marks.event, row.try_get(0)?) && is_there(&marks.result, row.try_get(1)?))
}

/// Returns the last rows on the server.
async fn last_rows(client: &impl GenericClient) -> Result<Marks, ServerErrorKind> {
    let event = client.query_opt("SELECT id, uid FROM event ORDER BY id DESC LIMIT 1", &[]).await?;
    let result = client.query_opt("SELECT id, event FROM result ORDER BY id DESC LIMIT 1", &[]).await?;
    let mark = |row: Option<Row>| row.map_or(Ok(Mark::default()), |row| read_mark(&row));
    Ok(Marks { event: mark(event)?, result: mark(result)? })
}

/// Receives the next rows from the server, at most `size` events and `size` results. A result never arrives before its
/// event, because both are read in one transaction.
async fn receive(postgres: &mut Postgres, after: &Marks, size: usize) -> Result<(Rows, Marks), ServerErrorKind> {
    let builder = postgres.build_transaction().isolation_level(IsolationLevel::RepeatableRead).read_only(true);
    let transaction = builder.start().await?;
    let rows = rows_after(&transaction, after, size).await?;
    transaction.commit().await?;
    Ok(rows)
}

async fn rows_after(client: &impl GenericClient, after: &Marks, size: usize) -> Result<(Rows, Marks), ServerErrorKind> {
    let limit = size as i64;
    let sql = r#"SELECT id, uid, at, what, kind, device_type, serial_number, is_virtual, description, items,
                        planned_cycles, backup, bench, "user", version, asset,
                        undoes
                 FROM event WHERE id > $1 ORDER BY id LIMIT $2"#;
    let (mut rows, mut marks) = (Rows::default(), after.clone());
    for row in client.query(sql, &[&after.event.number, &limit]).await? {
        marks.event = read_mark(&row)?;
        rows.events.push(read_event(&row)?);
    }
    if rows.events.len() < size {
        let sql = "SELECT id, event, at, outcome, failure, cycles_spent FROM result WHERE id > $1 ORDER BY id LIMIT $2";
        for row in client.query(sql, &[&after.result.number, &limit]).await? {
            marks.result = read_mark(&row)?;
            rows.results.push(read_result(&row)?);
        }
    }
    Ok((rows, marks))
}

/// Sends rows and receives the next rows from the server. Returns the marks after both.
async fn send(
    postgres: &mut Postgres,
    own: &Rows,
    after: &Marks,
    size: usize,
) -> Result<(Rows, Marks), ServerErrorKind> {
    let transaction = postgres.transaction().await?;
    schema::lock(&transaction).await?;
    let (rows, mut marks) = rows_after(&transaction, after, size).await?;
    add_events(&transaction, &own.events).await?;
    add_results(&transaction, &own.results).await?;
    // All rows up to those just sent are known now, unless one request could not return them all.
    if rows.largest_count() < size {
        marks = last_rows(&transaction).await?;
    }
    transaction.commit().await?;
    Ok((rows, marks))
}

async fn add_events(client: &impl GenericClient, events: &[EventRow]) -> Result<(), ServerErrorKind> {
    if events.is_empty() {
        return Ok(());
    }
    let texts = |of: fn(&EventRow) -> &String| events.iter().map(|row| storable(of(row))).collect::<Vec<_>>();
    let options = |of: fn(&EventRow) -> &Option<String>| {
        events.iter().map(|row| of(row).as_deref().map(storable)).collect::<Vec<_>>()
    };
    let sql = r#"INSERT INTO event (uid, at, what, kind, device_type, serial_number, is_virtual, description, items,
                                    planned_cycles, backup, bench, "user", version, asset, undoes)
        SELECT uid, at, what, kind, device_type, serial_number, is_virtual, description, items, planned_cycles, backup,
               bench, "user", version, asset, undoes
        FROM unnest($1::text[], $2::text[], $3::text[], $4::text[], $5::text[], $6::text[], $7::int[], $8::text[],
                    $9::text[], $10::bigint[], $11::text[], $12::text[], $13::text[], $14::text[], $15::text[],
                    $16::text[])
            WITH ORDINALITY AS own (uid, at, what, kind, device_type, serial_number, is_virtual, description, items,
                                    planned_cycles, backup, bench, "user", version, asset, undoes, place)
        ORDER BY place
        ON CONFLICT (uid) DO NOTHING"#;
    let virtuals: Vec<i32> = events.iter().map(|row| row.is_virtual).collect();
    let cycles: Vec<i64> = events.iter().map(|row| row.planned_cycles).collect();
    client
        .execute(
            sql,
            &[
                &texts(|row| &row.uid),
                &texts(|row| &row.at),
                &texts(|row| &row.what),
                &texts(|row| &row.kind),
                &texts(|row| &row.device_type),
                &texts(|row| &row.serial_number),
                &virtuals,
                &texts(|row| &row.description),
                &texts(|row| &row.items),
                &cycles,
                &options(|row| &row.backup),
                &texts(|row| &row.bench),
                &options(|row| &row.user),
                &texts(|row| &row.version),
                &options(|row| &row.asset),
                &options(|row| &row.undoes),
            ],
        )
        .await?;
    Ok(())
}

async fn add_results(client: &impl GenericClient, results: &[ResultRow]) -> Result<(), ServerErrorKind> {
    if results.is_empty() {
        return Ok(());
    }
    let texts = |of: fn(&ResultRow) -> &String| results.iter().map(|row| storable(of(row))).collect::<Vec<_>>();
    let failures: Vec<_> = results.iter().map(|row| row.failure.as_deref().map(storable)).collect();
    let cycles: Vec<i64> = results.iter().map(|row| row.cycles_spent).collect();
    let sql = "INSERT INTO result (event, at, outcome, failure, cycles_spent)
        SELECT event, at, outcome, failure, cycles_spent
        FROM unnest($1::text[], $2::text[], $3::text[], $4::text[], $5::bigint[])
            WITH ORDINALITY AS own (event, at, outcome, failure, cycles_spent, place)
        ORDER BY place
        ON CONFLICT (event) DO NOTHING";
    let (events, times, outcomes) = (texts(|row| &row.event), texts(|row| &row.at), texts(|row| &row.outcome));
    client.execute(sql, &[&events, &times, &outcomes, &failures, &cycles]).await?;
    Ok(())
}

/// Returns a text without NUL characters, which PostgreSQL cannot store.
fn storable(text: impl AsRef<str>) -> String {
    text.as_ref().replace('\0', "\u{fffd}")
}

fn read_mark(row: &Row) -> Result<Mark, tokio_postgres::Error> {
    Ok(Mark { number: row.try_get(0)?, uid: row.try_get(1)? })
}

fn read_event(row: &Row) -> Result<EventRow, tokio_postgres::Error> {
    Ok(EventRow {
        uid: row.try_get(1)?,
        at: row.try_get(2)?,
        what: row.try_get(3)?,
        kind: row.try_get(4)?,
        device_type: row.try_get(5)?,
        serial_number: row.try_get(6)?,
        is_virtual: row.try_get(7)?,
        description: row.try_get(8)?,
        items: row.try_get(9)?,
        planned_cycles: row.try_get(10)?,
        backup: row.try_get(11)?,
        bench: row.try_get(12)?,
        user: row.try_get(13)?,
        version: row.try_get(14)?,
        asset: row.try_get(15)?,
        undoes: row.try_get(16)?,
    })
}

fn read_result(row: &Row) -> Result<ResultRow, tokio_postgres::Error> {
    Ok(ResultRow {
        event: row.try_get(1)?,
        at: row.try_get(2)?,
        outcome: row.try_get(3)?,
        failure: row.try_get(4)?,
        cycles_spent: row.try_get(5)?,
    })
}
