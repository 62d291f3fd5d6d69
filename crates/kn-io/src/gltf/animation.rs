//! Key frames, and the values between them.

use super::super::{Fault, MeshErrorKind};
use super::accessor::{Accessor, Budget, Document};
use super::bad;
use super::json::{Animation as Json, Channel as JsonChannel, Target};
use super::nodes::{Nodes, unit};
use glam::{DQuat, DVec3};

/// Most frames that one animation is sampled into.
const MAX_FRAMES: f64 = 500_000.0;

/// The largest distance, in frames, at which a sample before a step counts as on it: times are
/// binary32 in the file, so the key of frame 1 at 30 fps lies after 1/30. Enough for
/// [`MAX_FRAMES`].
const ON_KEY_FRAME: f64 = 0.05;

/// The channels of one animation.
#[derive(Debug)]
pub(super) struct Animation {
    channels: Vec<Channel>,
    /// Times of the first and the last key frame of all channels, in seconds.
    start: f64,
    end: f64,
}

/// One property of one node as a function of time.
#[derive(Debug)]
struct Channel {
    node: usize,
    property: Property,
    interpolation: Interpolation,
    /// Ascending, in seconds.
    times: Vec<f64>,
    /// `#times × width`; with cubic splines `#times × 3 × width`: in-tangent, value, out-tangent.
    values: Vec<f64>,
    width: usize,
}

/// The properties that move something.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Property {
    Translation,
    Rotation,
    Scale,
    Weights,
    Visibility,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Interpolation {
    Linear,
    Step,
    CubicSpline,
}

impl Animation {
    /// Loads an animation, `None` where it moves nothing, and the number of channels that move
    /// nothing.
    pub(super) fn load(
        document: &Document,
        nodes: &Nodes,
        json: &Json,
        budget: &mut Budget,
    ) -> Result<(Option<Self>, u64), Fault> {
        let mut channels = Vec::new();
        for channel in &json.channels {
            if let Some(moved) = moved_by(&channel.target) {
                channels.push(Channel::load(document, nodes, (json, channel), moved, budget)?);
            }
        }
        let others = (json.channels.len() - channels.len()) as u64;
        let first = |channel: &Channel| channel.times.first().copied();
        let last = |channel: &Channel| channel.times.last().copied();
        let start = channels.iter().filter_map(first).fold(f64::INFINITY, f64::min);
        let end = channels.iter().filter_map(last).fold(start, f64::max);
        Ok(((!channels.is_empty()).then_some(Self { channels, start, end }), others))
    }

    /// The number of frames from the first key frame to the last, both included.
    pub(super) fn frame_count(&self, frame_rate: f64) -> Result<usize, Fault> {
        if !(frame_rate.is_finite() && frame_rate > 0.0) {
            let what = format!("a frame rate of {frame_rate}");
            return Err(MeshErrorKind::Unsupported(what).into());
        }
        let frames = ((self.end - self.start) * frame_rate + ON_KEY_FRAME).floor() + 1.0;
        if frames <= MAX_FRAMES {
            return Ok(frames as usize);
        }
        let kind = MeshErrorKind::TooLarge {
            what: "frames of the animation",
            asked: frames as u64,
            allowed: MAX_FRAMES as u64,
        };
        Err(kind.into())
    }

    /// Puts the nodes where they are in a frame, and the weights of morph targets of their
    /// meshes into `weights` (one entry per node).
    pub(super) fn apply(
        &self,
        frame: usize,
        frame_rate: f64,
        nodes: &mut Nodes,
        weights: &mut [Option<Vec<f64>>],
    ) {
        for channel in &self.channels {
            let time = self.start + frame as f64 / frame_rate;
            let values = channel.at(time, ON_KEY_FRAME / frame_rate);
            let node = &mut nodes.nodes[channel.node];
            match (channel.property, &values[..]) {
                (Property::Translation, &[x, y, z]) => node.translation = DVec3::new(x, y, z),
                (Property::Scale, &[x, y, z]) => node.scale = DVec3::new(x, y, z),
                (Property::Rotation, &[x, y, z, w]) => {
                    node.rotation = unit(DQuat::from_xyzw(x, y, z, w));
                }
                (Property::Visibility, &[visible]) => node.visible = visible != 0.0,
                _ => weights[channel.node] = Some(values),
            }
        }
    }
}

/// The node that an animation moves, and the property; `None` where it moves nothing: a material, a
/// light, a camera.
fn moved_by(target: &Target) -> Option<(usize, Property)> {
    let pointer = target.extensions.get("KHR_animation_pointer");
    let (node, path) = match pointer.and_then(|object| object.get("pointer")?.as_str()) {
        None => (target.node?, target.path.as_str()),
        Some(pointer) => {
            let (node, path) = pointer.strip_prefix("/nodes/")?.split_once('/')?;
            (node.parse().ok()?, path)
        }
    };
    let property = match path {
        "translation" => Property::Translation,
        "rotation" => Property::Rotation,
        "scale" => Property::Scale,
        "weights" => Property::Weights,
        "extensions/KHR_node_visibility/visible" => Property::Visibility,
        _ => return None,
    };
    Some((node, property))
}

impl Channel {
    fn load(
        document: &Document,
        nodes: &Nodes,
        (animation, json): (&Json, &JsonChannel),
        (node, property): (usize, Property),
        budget: &mut Budget,
    ) -> Result<Self, Fault> {
        let places = !matches!(property, Property::Weights | Property::Visibility);
        if nodes.nodes.get(node).is_none_or(|node| places && node.matrix.is_some()) {
            return Err(bad(format!("an animation moves node {node}, which cannot be moved")));
        }
        let sampler = animation.samplers.get(json.sampler);
        let sampler = sampler.ok_or_else(|| bad("an animation has no such sampler"))?;
        let interpolation = match sampler.interpolation.as_deref() {
            _ if property == Property::Visibility => Interpolation::Step,
            None | Some("LINEAR") => Interpolation::Linear,
            Some("STEP") => Interpolation::Step,
            Some("CUBICSPLINE") => Interpolation::CubicSpline,
            Some(_) => return Err(bad("an animation of an unknown kind")),
        };
        let times = Accessor::open_wide(document, sampler.input, 1, budget)?.read(document);
        if !times.iter().all(|time| time.is_finite()) || !times.is_sorted() || times.is_empty() {
            return Err(bad("the key frames of an animation are not in order"));
        }
        let values = Accessor::open(document, sampler.output, budget)?.read(document);
        let keys = times.len() * if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let width = values.len() / keys;
        let right = match property {
            Property::Translation | Property::Scale => width == 3,
            Property::Rotation => width == 4,
            Property::Weights => width > 0,
            Property::Visibility => width == 1,
        };
        if !right || width * keys != values.len() {
            return Err(bad("an animation has not one value per key frame"));
        }
        Ok(Self { node, property, interpolation, times, values, width })
    }

    /// The value at a time; before the first key frame the first, after the last the last.
    /// Steps count as reached `tolerance` seconds earlier.
    fn at(&self, time: f64, tolerance: f64) -> Vec<f64> {
        let tolerance = if self.interpolation == Interpolation::Step { tolerance } else { 0.0 };
        let after = self.times.partition_point(|&key| key <= time + tolerance);
        let before = after.saturating_sub(1);
        let last = self.times.len() - 1;
        if after == 0 || before == last || self.interpolation == Interpolation::Step {
            return self.key(before);
        }
        let (from, to) = (self.times[before], self.times[after]);
        let span = to - from;
        let s = ((time - from) / span).clamp(0.0, 1.0);
        match (self.interpolation, self.property) {
            (Interpolation::CubicSpline, _) => self.spline(before, s, span),
            (_, Property::Rotation) => slerp(&self.key(before), &self.key(after), s),
            _ => mix(&self.key(before), &self.key(after), 1.0 - s, s),
        }
    }

    /// The value of a key frame.
    fn key(&self, key: usize) -> Vec<f64> {
        match self.interpolation {
            Interpolation::CubicSpline => self.row(3 * key + 1),
            _ => self.row(key),
        }
    }

    fn row(&self, row: usize) -> Vec<f64> {
        self.values[row * self.width..][..self.width].to_vec()
    }

    /// The cubic Hermite spline from key frame `key` to the next, which is `span` seconds later.
    fn spline(&self, key: usize, s: f64, span: f64) -> Vec<f64> {
        let (value, out_tangent) = (self.row(3 * key + 1), self.row(3 * key + 2));
        let (in_tangent, next) = (self.row(3 * key + 3), self.row(3 * key + 4));
        let (s2, s3) = (s * s, s * s * s);
        let values = mix(&value, &next, 2.0 * s3 - 3.0 * s2 + 1.0, 3.0 * s2 - 2.0 * s3);
        let tangents = mix(&out_tangent, &in_tangent, span * (s3 - 2.0 * s2 + s), span * (s3 - s2));
        mix(&values, &tangents, 1.0, 1.0)
    }
}

fn mix(a: &[f64], b: &[f64], weight_a: f64, weight_b: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * weight_a + b * weight_b).collect()
}

/// Spherical interpolation of quaternions on the shorter arc, by libm: the same on every machine.
fn slerp(a: &[f64], b: &[f64], s: f64) -> Vec<f64> {
    let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    let sign = if dot < 0.0 { -1.0 } else { 1.0 };
    let angle = libm::acos((dot * sign).min(1.0));
    let sine = libm::sin(angle);
    if sine < 1e-6 {
        // So close that a straight line is exact; the caller normalises.
        return mix(a, b, 1.0 - s, sign * s);
    }
    let weight = |s: f64| libm::sin(s * angle) / sine;
    mix(a, b, weight(1.0 - s), sign * weight(s))
}

#[cfg(test)]
#[allow(clippy::disallowed_methods)]
mod tests {
    use super::*;

    fn channel(interpolation: Interpolation, values: &[f64]) -> Channel {
        let times = vec![1.0, 2.0, 4.0];
        let keys = if interpolation == Interpolation::CubicSpline { 9 } else { 3 };
        let width = values.len() / keys;
        let property = if width == 4 { Property::Rotation } else { Property::Weights };
        Channel { node: 0, property, interpolation, times, values: values.to_vec(), width }
    }

    #[test]
    fn steps_hold_and_lines_mix() {
        let step = channel(Interpolation::Step, &[5.0, 6.0, 8.0]);
        let line = channel(Interpolation::Linear, &[5.0, 6.0, 8.0]);
        let cases = [(0.0, 5.0, 5.0), (1.5, 5.0, 5.5), (2.0, 6.0, 6.0), (3.0, 6.0, 7.0)];
        for (time, stepped, mixed) in cases.into_iter().chain([(9.0, 8.0, 8.0)]) {
            assert_eq!(step.at(time, 1e-6), [stepped], "step at {time}");
            assert_eq!(line.at(time, 1e-6), [mixed], "line at {time}");
        }
        assert_eq!(step.at(2.0 - 1e-7, 1e-6), [6.0], "a rounded key frame is met");
        assert!(line.at(1.9, 0.2)[0] < 5.95, "lines do not jump");
    }

    #[test]
    fn a_spline_through_a_parabola_is_exact() {
        // t² at 1, 2, 4 with its own slopes 2t.
        let spline =
            channel(Interpolation::CubicSpline, &[2.0, 1.0, 2.0, 4.0, 4.0, 4.0, 8.0, 16.0, 8.0]);
        for time in [1.0, 1.25, 1.9, 2.0, 3.0, 3.7, 4.0] {
            assert!((spline.at(time, 0.0)[0] - time * time).abs() < 1e-12, "at {time}");
        }
    }

    #[test]
    fn rotations_turn_evenly_on_the_shorter_arc() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        // No turn, a quarter turn about x, the same with the other sign.
        let keys = [0.0, 0.0, 0.0, 1.0, half, 0.0, 0.0, half, -half, 0.0, 0.0, -half];
        let turn = channel(Interpolation::Linear, &keys);
        let third = turn.at(1.0 + 1.0 / 3.0, 0.0);
        let expected = [(std::f64::consts::PI / 12.0).sin(), (std::f64::consts::PI / 12.0).cos()];
        assert!((third[0] - expected[0]).abs() < 1e-7 && (third[3] - expected[1]).abs() < 1e-7);
        let still = turn.at(3.0, 0.0);
        assert!((still[0] - half).abs() < 1e-7, "{still:?}");
    }
}
