//! The tables of the logbook on the server. They match the tables of the local file, but use the SQL dialect of
//! PostgreSQL. The `logbook` table contains the schema number.

use tokio_postgres::Transaction;

use super::client::Client;
use super::error::ServerErrorKind;

/// Migrations from each schema to the next. Existing migrations must never change, because servers have already applied
/// them.
///
/// The numbers of events and results increase in the order in which the rows become visible, because all computers add
/// rows while they hold a lock. A computer can therefore continue after the last number that it knows.
pub(super) const STEPS: [&str; 3] = [
    r#"
    CREATE TABLE logbook (
        identity TEXT    NOT NULL, -- a bench that meets another identity sends all of its entries
        schema   INTEGER NOT NULL
    );
    INSERT INTO logbook VALUES (gen_random_uuid()::text, 0);
    CREATE TABLE event (
        id             BIGINT  GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
        uid            TEXT    NOT NULL UNIQUE,
        at             TEXT    NOT NULL, -- RFC 3339, UTC
        what           TEXT    NOT NULL,
        kind           TEXT    NOT NULL,
        device_type    TEXT    NOT NULL,
        serial_number  TEXT    NOT NULL,
        is_virtual     INTEGER NOT NULL CHECK (is_virtual IN (0, 1)),
        description    TEXT    NOT NULL,
        items          TEXT    NOT NULL DEFAULT '[]', -- JSON: a list of item, name, old, new
        planned_cycles BIGINT  NOT NULL DEFAULT 0 CHECK (planned_cycles >= 0),
        backup         TEXT,             -- a path on the bench
        bench          TEXT    NOT NULL,
        "user"         TEXT,
        version        TEXT    NOT NULL,
        asset          TEXT              -- the asset to which the device is assigned from now on, of 'assigned' only
    );
    CREATE INDEX event_of_device ON event (kind, serial_number, device_type, is_virtual);
    CREATE TABLE result (
        id             BIGINT  GENERATED ALWAYS AS IDENTITY UNIQUE,
        event          TEXT    PRIMARY KEY REFERENCES event (uid),
        at             TEXT    NOT NULL, -- RFC 3339, UTC
        outcome        TEXT    NOT NULL CHECK (outcome IN ('done', 'failed', 'cancelled')),
        failure        TEXT,             -- the reason, of 'failed' only
        cycles_spent   BIGINT  NOT NULL CHECK (cycles_spent >= 0),
        CHECK ((outcome = 'failed') = (failure IS NOT NULL))
    );
"#,
    // Devices that are currently connected to a computer.
    r#"
    CREATE TABLE hold (
        program        TEXT        NOT NULL, -- the running program
        kind           TEXT        NOT NULL,
        device_type    TEXT        NOT NULL,
        serial_number  TEXT        NOT NULL,
        bench          TEXT        NOT NULL,
        "user"         TEXT,
        until          TIMESTAMPTZ NOT NULL, -- renewed while the device is connected
        PRIMARY KEY (program, kind, device_type, serial_number)
    );
    CREATE INDEX hold_of_device ON hold (kind, serial_number, device_type);
"#,
    // uid of the event that this event undoes.
    "ALTER TABLE event ADD COLUMN undoes TEXT",
];

const SCHEMA_VERSION: i64 = STEPS.len() as i64;

/// Key of the lock held while rows are added or tables are changed. It makes row numbers increase in the order in which
/// the rows become visible.
const LOCK: i64 = 0x656e_636f_6465_7273;

/// Waits for the lock and holds it until the end of the transaction.
pub(super) async fn lock(transaction: &Transaction<'_>) -> Result<(), ServerErrorKind> {
    transaction.execute("SELECT pg_advisory_xact_lock($1)", &[&LOCK]).await?;
    Ok(())
}

/// Creates or updates the tables if necessary, and returns the identity of the logbook.
pub(super) fn prepare(client: &mut Client) -> Result<String, ServerErrorKind> {
    client.run(async |postgres| {
        if let Some((identity, found)) = read(postgres).await?
            && check(found)? == STEPS.len()
        {
            return Ok(identity);
        }
        let transaction = postgres.transaction().await?;
        lock(&transaction).await?;
        // Another computer may have changed the tables in the meantime.
        let found = read(&transaction).await?.map_or(0, |(_, found)| found);
        let migrated = migrate(&transaction, check(found)?).await;
        migrated.map_err(|problem| match problem {
            ServerErrorKind::NoRights { .. } if found > 0 => ServerErrorKind::Older { found, known: SCHEMA_VERSION },
            problem => problem,
        })?;
        let (identity, _) = read(&transaction).await?.unwrap_or_default();
        transaction.commit().await?;
        Ok(identity)
    })
}

/// Returns the number of entries, or `None` if the database has no logbook yet. Does not change the database.
pub(super) fn count_entries(client: &mut Client) -> Result<Option<u64>, ServerErrorKind> {
    client.run(async |postgres| {
        match read(postgres).await? {
            Some((_, found)) => check(found)?,
            None => return Ok(None),
        };
        let count: i64 = postgres.query_one("SELECT count(*) FROM event", &[]).await?.try_get(0)?;
        Ok(u64::try_from(count).ok())
    })
}

async fn migrate(transaction: &Transaction<'_>, done: usize) -> Result<(), ServerErrorKind> {
    for step in STEPS.iter().skip(done) {
        transaction.batch_execute(step).await?;
    }
    transaction.execute("UPDATE logbook SET schema = $1", &[&(STEPS.len() as i32)]).await?;
    Ok(())
}

/// Returns the logbook's identity and schema number, or `None` if the database has no logbook.
async fn read(client: &impl tokio_postgres::GenericClient) -> Result<Option<(String, i64)>, ServerErrorKind> {
    let exists = client.query_one("SELECT to_regclass('logbook') IS NOT NULL", &[]).await?;
    if !exists.try_get(0)? {
        return Ok(None);
    }
    let row = client.query_opt("SELECT identity, schema::bigint FROM logbook", &[]).await?;
    row.map(|row| Ok((row.try_get(0)?, row.try_get(1)?))).transpose()
}

/// Returns the number of migrations that have been applied.
fn check(found: i64) -> Result<usize, ServerErrorKind> {
    match usize::try_from(found) {
        Ok(done) if done <= STEPS.len() => Ok(done),
        _ => Err(ServerErrorKind::Newer { found, known: SCHEMA_VERSION }),
    }
}
