//! Real-time priority for the threads of cyclic connections. Their packets are due every few milliseconds, and ordinary
//! threads on a busy computer may wait longer.

use thread_priority::{Error, ThreadPriority};

/// Requests real-time priority for the calling thread, until the thread ends. Returns whether the system granted the
/// request. On Linux, the user needs the `rtprio` permission.
pub fn request_realtime_priority() -> bool {
    let asked = request_realtime();
    if let Err(error) = &asked {
        tracing::debug!("a thread of the cyclic connection is an ordinary one: {error}");
    }
    asked.is_ok()
}

/// Requests the lowest real-time priority, which is above all ordinary priorities.
#[cfg(unix)]
fn request_realtime() -> Result<(), Error> {
    use thread_priority::unix::{
        RealtimeThreadSchedulePolicy, ThreadSchedulePolicy, set_thread_priority_and_policy, thread_native_id,
    };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::RoundRobin);
    set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Min, policy)
}

#[cfg(not(unix))]
fn request_realtime() -> Result<(), Error> {
    ThreadPriority::Max.set_for_current()
}
