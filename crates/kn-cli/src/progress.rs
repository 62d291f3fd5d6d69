//! Progress bars: on long work, and only where somebody looks at a terminal.

use crate::arguments::Global;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar over `total` steps; without a known total it counts. It disappears when dropped.
pub(crate) fn bar(global: &Global, task: &'static str, total: Option<u64>) -> Bar {
    // indicatif itself draws nothing where stderr is no terminal.
    let target =
        if global.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(total, target).with_message(task);
    let template = match total {
        Some(_) => "{msg:>10} {wide_bar} {pos}/{len} frames, {eta} left",
        None => "{msg:>10} {spinner} {pos} frames, {elapsed}",
    };
    // The templates are constants; a mistake in one only costs the bar its look.
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    Bar(bar)
}

/// A running bar.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    /// One frame more is done.
    pub(crate) fn step(&self) {
        self.0.inc(1);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
