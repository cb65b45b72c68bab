//! Tasks of the Signals tab. Every task delivers a result, even if it could not be started or was aborted.

use super::{TAB, TaskResult};
use crate::app::action::{Action, TaskResult as StudioDone};
use crate::app::tasks::{ActionMailbox, TaskRunner};

/// Guard that reports a failure if the task ends without a result.
struct CompletionGuard {
    mailbox: ActionMailbox,
    failed: Option<TaskResult>,
}

impl CompletionGuard {
    fn task_returned(mut self) {
        self.failed = None;
    }
}

impl Drop for CompletionGuard {
    fn drop(&mut self) {
        if let Some(failed) = self.failed.take() {
            self.mailbox.send(done_action(failed));
        }
    }
}

fn done_action(done: TaskResult) -> Action {
    Action::Done(StudioDone::from_tool(TAB, done))
}

/// Runs a task on a thread. If the task ends without a result, `failed` is delivered instead.
pub(super) fn run(
    tasks: &TaskRunner,
    name: &str,
    failed: TaskResult,
    task: impl FnOnce() -> TaskResult + Send + 'static,
) {
    let promise = CompletionGuard { mailbox: tasks.mailbox(), failed: Some(failed) };
    tasks.run(name, move || {
        let done = task();
        promise.task_returned();
        done_action(done)
    });
}

/// Drops a large value on another thread, because releasing its memory can take a long time.
pub(super) fn drop_in_background(tasks: &TaskRunner, large: impl Send + 'static) {
    tasks.run("let go", move || {
        drop(large);
        done_action(TaskResult::ValueDropped)
    });
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::FailedTask;
    use super::*;

    fn next(tasks: &TaskRunner) -> Option<FailedTask> {
        let began = std::time::Instant::now();
        loop {
            match tasks.next() {
                Some(Action::Done(StudioDone::Tool(_, done))) => match done.open() {
                    Ok(TaskResult::Failed(failed)) => return Some(failed),
                    other => panic!("{:?}", other.is_ok()),
                },
                Some(_) => {}
                None if began.elapsed().as_secs() > 20 => return None,
                None => std::thread::sleep(std::time::Duration::from_millis(1)),
            }
        }
    }

    #[test]
    fn reports_only_panicking_task() {
        let tasks = TaskRunner::new(Arc::new(|| ()));
        run(&tasks, "ends", TaskResult::Failed(FailedTask::Judge), || TaskResult::Failed(FailedTask::Measure(1)));
        assert_eq!(next(&tasks), Some(FailedTask::Measure(1)));
        run(&tasks, "breaks off", TaskResult::Failed(FailedTask::Read(7)), || std::panic::resume_unwind(Box::new(())));
        assert_eq!(next(&tasks), Some(FailedTask::Read(7)));
        assert!(tasks.next().is_none());
    }
}
