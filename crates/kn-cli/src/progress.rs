//! Progress bars for long work, on terminals only.

use crate::arguments::Global;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar over `total` frames; without a known total it counts. It disappears when dropped.
pub(crate) fn bar(global: &Global, task: &'static str, total: Option<u64>) -> Bar {
    bar_over("frames", global, task, total)
}

/// A bar over things of another name.
pub(crate) fn bar_over(
    things: &str,
    global: &Global,
    task: &'static str,
    total: Option<u64>,
) -> Bar {
    // indicatif itself draws nothing where stderr is no terminal.
    let target =
        if global.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(total, target).with_message(task);
    let template = match total {
        Some(_) => format!("{{msg:>10}} {{wide_bar}} {{pos}}/{{len}} {things}, {{eta}} left"),
        None => format!("{{msg:>10}} {{spinner}} {{pos}} {things}, {{elapsed}}"),
    };
    // Only a mistake here can make the template wrong, and it only costs the bar its look.
    if let Ok(style) = ProgressStyle::with_template(&template) {
        bar.set_style(style);
    }
    Bar(bar)
}

/// A running bar.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    /// One more is done.
    pub(crate) fn step(&self) {
        self.0.inc(1);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
