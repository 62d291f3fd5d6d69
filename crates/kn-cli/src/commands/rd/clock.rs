//! Processor time of a step, which does not depend on other load of the machine.

/// Runs a step in the current pool and adds its processor seconds to `seconds`.
pub(super) fn timed<T>(seconds: &mut f64, step: impl FnOnce() -> T) -> T {
    let before = pool_seconds();
    let value = step();
    *seconds += pool_seconds() - before;
    value
}

/// Seconds that the threads of the current pool have worked, each since it began.
fn pool_seconds() -> f64 {
    rayon::broadcast(|_| thread_seconds()).into_iter().sum()
}

#[cfg(unix)]
fn thread_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Wall-clock time, where threads have no clock of their own that safe code can read.
#[cfg(not(unix))]
fn thread_seconds() -> f64 {
    use std::sync::LazyLock;
    use std::time::Instant;
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64() / rayon::current_num_threads() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;

    #[test]
    fn work_of_all_threads_counts() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
        let mut seconds = 0.0;
        let sum: f64 = pool.install(|| {
            timed(&mut seconds, || {
                (0..4_000_000_u32).into_par_iter().map(|i| f64::from(i).sqrt()).sum()
            })
        });
        assert!(sum > 0.0 && seconds > 0.0 && seconds < 60.0, "{seconds}");
    }
}
