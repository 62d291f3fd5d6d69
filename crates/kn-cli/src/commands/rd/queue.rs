//! Work that is done by several threads at a time.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Does `work` on `0..count`, `jobs` items at a time, each inside a pool of `threads` threads.
/// Results come in the order of the items.
///
/// # Errors
/// The threads cannot be started.
pub(super) fn run<T: Send>(
    count: usize,
    jobs: usize,
    threads: usize,
    work: impl Fn(usize) -> T + Sync,
) -> anyhow::Result<Vec<T>> {
    let pools: Result<Vec<_>, _> = (0..jobs.min(count))
        .map(|_| rayon::ThreadPoolBuilder::new().num_threads(threads).build())
        .collect();
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::new());
    let (next, results_of, work) = (&next, &results, &work);
    std::thread::scope(|scope| {
        for pool in pools? {
            scope.spawn(move || {
                pool.install(|| {
                    loop {
                        let item = next.fetch_add(1, Ordering::Relaxed);
                        if item >= count {
                            break;
                        }
                        let result = work(item);
                        lock(results_of).push((item, result));
                    }
                });
            });
        }
        Ok::<_, rayon::ThreadPoolBuildError>(())
    })?;
    let mut results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.sort_by_key(|result| result.0);
    Ok(results.into_iter().map(|result| result.1).collect())
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_is_done_once_and_in_order() {
        for jobs in [1, 2, 7] {
            let squares = run(20, jobs, 1, |item| item * item).expect("threads");
            assert_eq!(squares, (0..20).map(|item| item * item).collect::<Vec<_>>());
        }
        assert!(run(0, 3, 1, |item| item).expect("nothing").is_empty());
    }
}
