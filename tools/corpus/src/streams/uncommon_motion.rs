//! P-frames whose result hangs on a weight or a rounding. Their meshes are vertices
//! without faces.

use anyhow::{Context, Result};

use kn_mesh::GridMesh;

use super::Draft;
use super::shapes::Noise;
use super::texts::{HEADER, INDEX, Text, intra_unit, payload_of};

/// Grid steps from the middle of the grid to its end.
const LIMIT: i64 = 1 << 20;

pub(crate) fn drafts() -> Result<Vec<Draft>> {
    let mut drafts = vec![largest_position()?];
    for (slots, name) in [(3, "ties_3"), (5, "ties_5"), (6, "ties_6"), (7, "ties_7")] {
        drafts.push(ties(name, slots, slots)?);
    }
    drafts.push(ties("ties_one_node", 6, 1)?);
    for (scheme, name) in
        [(0, "few_nodes_inverse"), (1, "few_nodes_sumner"), (2, "few_nodes_gaussian")]
    {
        drafts.push(few_nodes(name, scheme)?);
    }
    Ok(drafts)
}

pub(crate) fn faulty() -> Result<Vec<Draft>> {
    let position = Some("deform.position.range");
    let translation = Some("motion.translation.range");
    Ok(vec![
        at_the_limit(LIMIT_EXACT, |x| [x, 0, 0])?.draft(
            "position_at_limit",
            "A sum of 2^20 − 1/2 steps, which would be rounded to 2^20.",
            position,
            LIMIT_RULES,
        )?,
        at_the_limit(LIMIT_EXACT, |x| [0, 0, -x])?.draft(
            "position_at_lower_limit",
            "A sum of −2^20 + 1/2 steps.",
            position,
            LIMIT_RULES,
        )?,
        moved_across(1).draft(
            "translation_grid",
            "A translation by 2^20 grid steps, whatever the fraction, between two places in the grid.",
            translation,
            &[],
        )?,
        moved_across(-1).draft(
            "translation_grid_back",
            "A translation by −2^20 grid steps between two places in the grid.",
            translation,
            &[],
        )?,
    ])
}

/// Nodes as points, and one P-frame for each entry of `motions`.
pub(crate) struct Scene {
    pub(crate) header: Text,
    pub(crate) mesh: GridMesh,
    pub(crate) nodes: Vec<[i32; 3]>,
    pub(crate) affine: bool,
    pub(crate) sigma: Option<u32>,
    pub(crate) motions: Vec<Motion>,
}

/// Values of a P-frame: translation, and rotation of rigid or scale of affine nodes.
#[derive(Default)]
pub(crate) struct Motion {
    pub(crate) translation: Vec<[i32; 3]>,
    pub(crate) turn_or_scale: Vec<[i32; 3]>,
    pub(crate) steps: [u8; 2],
    /// `translation_mode`.
    pub(crate) mode: u8,
    /// `translation_change`, for mode 2.
    pub(crate) changes: Vec<[i32; 3]>,
}

impl Scene {
    fn text(&self) -> Result<String> {
        Ok(format!("{}{}{INDEX}", self.header.clone().build(), self.group()?))
    }

    /// The units of a GoF.
    pub(crate) fn group(&self) -> Result<String> {
        let intra = intra_unit(&payload_of(&self.mesh)?);
        let motions: String = self.motions.iter().map(|motion| self.motion(motion)).collect();
        Ok(intra + &self.nodes_unit() + &motions)
    }

    fn nodes_unit(&self) -> String {
        let before = [[0; 3]].into_iter().chain(self.nodes.iter().copied());
        let deltas: Vec<[i32; 3]> = before
            .zip(&self.nodes)
            .map(|(before, node)| [0, 1, 2].map(|axis| node[axis] - before[axis]))
            .collect();
        let sigma = self.sigma.map_or(String::new(), |sigma| format!("weight_sigma = {sigma}\n"));
        format!(
            "\nunit_type = 3\nnode_count = {}\nnode_coding = 1\naffine_mode = {}\n{sigma}\
             node_delta_rice = 18\nnode_delta = {}\n",
            self.nodes.len(),
            if self.affine { 2 } else { 0 },
            numbers(&deltas),
        )
    }

    fn motion(&self, motion: &Motion) -> String {
        let values = numbers(&motion.turn_or_scale);
        let [translation_step, step] = motion.steps;
        let name = if self.affine { "scale" } else { "rotation" };
        let changes = match motion.mode {
            2 => format!("translation_change = {}\n", numbers(&motion.changes)),
            _ => String::new(),
        };
        format!(
            "\nunit_type = 4\ndigest_present = 0\nname_present = 0\nreference_mode = 0\n\
             entropy_mode = 0\nresidual_present = 0\ntranslation_mode = {}\nrotation_enabled = 0\n\
             scale_enabled = {}\nshear_enabled = 0\ntranslation_step = {translation_step}\n\
             translation_table = 30\n{name}_step = {step}\nparameter_table = 20\n\
             {changes}translation = {}\n{name} = {values}\n",
            motion.mode,
            u8::from(self.affine),
            numbers(&motion.translation),
        )
    }

    pub(crate) fn draft(
        &self,
        name: &str,
        danger: &str,
        rule: Option<&'static str>,
        covers: &'static [&'static str],
    ) -> Result<Draft> {
        Ok(Draft { name: name.into(), text: self.text()?, danger: danger.into(), rule, covers })
    }
}

fn numbers(points: &[[i32; 3]]) -> String {
    let all: Vec<String> = points.iter().flatten().map(i32::to_string).collect();
    all.join(" ")
}

/// Whole grid steps, `slots` nodes a vertex, no labels.
fn whole_steps(slots: usize) -> Text {
    Text::new(HEADER)
        .set("fraction_bits", 0, "0")
        .set("nodes_per_vertex", 0, &slots.to_string())
        .set("label_set", 0, "0")
}

fn cloud(positions: Vec<[i32; 3]>) -> GridMesh {
    GridMesh::new(positions, Vec::new())
}

/// All nodes in the origin, each in as many slots, so that weights are 1/Q; a scale of 1.5 makes
/// halves of odd coordinates, and translations add up to whole numbers of Q.
fn ties(name: &str, slots: usize, nodes: usize) -> Result<Draft> {
    let mut noise = Noise::new(slots as u64);
    let odd = |noise: &mut Noise| noise.point(3000).map(|x| 2 * x + 1);
    let positions = (0..40).map(|_| odd(&mut noise)).collect();
    let mut translation: Vec<[i32; 3]> = (1..nodes).map(|_| noise.point(9)).collect();
    let sum = |axis: usize| translation.iter().map(|t| t[axis]).sum::<i32>();
    let last = [0, 1, 2].map(|axis| -sum(axis).rem_euclid(slots as i32));
    translation.push(last);
    let scene = Scene {
        header: whole_steps(slots),
        mesh: cloud(positions),
        nodes: vec![[0; 3]; nodes],
        affine: true,
        sigma: None,
        // A step of 2^−8, 128 times.
        motions: vec![Motion {
            translation,
            turn_or_scale: vec![[128; 3]; nodes],
            steps: [0, 24],
            ..Motion::default()
        }],
    };
    let danger =
        "Sums of equal weights that are halves but for their rounding: their order, ties to even.";
    scene.draft(name, danger, None, &["deform.blend", "deform.round", "deform.weights.normalise"])
}

/// The excess of a coordinate times the scale over 2^20 − 1, in 2^−14 of a step.
const LIMIT_BELOW: i64 = 8191;
const LIMIT_EXACT: i64 = 8192;

fn largest_position() -> Result<Draft> {
    let danger = "A sum of 2^20 − 1/2 − 2^−14 steps is the largest, rounded it is 2^20 − 1; 2^20 − 1/2 is not.";
    let scene = at_the_limit(LIMIT_BELOW, |x| [x, 0, -x])?;
    scene.draft("largest_position", danger, None, LIMIT_RULES)
}

const LIMIT_RULES: &[&str] = &["deform.position.range", "deform.round"];

/// One node in the origin scales a vertex to the end of the grid.
fn at_the_limit(excess: i64, corner: fn(i32) -> [i32; 3]) -> Result<Scene> {
    let goal = (LIMIT - 1) * 16384 + excess;
    let found = (LIMIT / 2..LIMIT).rev().find(|x| goal % x == 0 && goal / x < 8 * 16384);
    let x = found.context("no coordinate reaches the limit")?;
    let scale = (goal / x - 16384) as i32;
    Ok(Scene {
        header: whole_steps(1),
        mesh: cloud(vec![[0, 5, 0], [7, 0, 1], corner(x as i32)]),
        nodes: vec![[0; 3]],
        affine: true,
        sigma: None,
        motions: vec![Motion {
            translation: vec![[0; 3]],
            turn_or_scale: vec![[scale; 3]],
            ..Motion::default()
        }],
    })
}

/// One node carries a few vertices from the middle of one half of the grid to that of the other.
fn moved_across(side: i32) -> Scene {
    let start = -side * (LIMIT / 2) as i32;
    Scene {
        header: whole_steps(1),
        mesh: cloud(vec![[start, 5, 0], [start + 7, 0, 1], [start - 3, 2, 0]]),
        nodes: vec![[start, 0, 0]],
        affine: false,
        sigma: None,
        // Steps of 2.
        motions: vec![Motion {
            translation: vec![[-start, 0, 0]],
            turn_or_scale: vec![[0; 3]],
            steps: [4, 0],
            ..Motion::default()
        }],
    }
}

/// Regions of 1, 2, 4 and 5 nodes where 4 move a vertex; one where all are as far; one where they
/// are closer than a step.
fn few_nodes(name: &str, scheme: u8) -> Result<Draft> {
    let mut noise = Noise::new(5);
    let (mut mesh, mut nodes) = (GridMesh::default(), Vec::new());
    for (region, count) in [(0, 1), (1, 2), (2, 4), (3, 5)] {
        let mut near = |reach| {
            let [x, y, z] = noise.point(reach);
            [1000 * i32::from(region) + x, y, z]
        };
        let placed: Vec<[i32; 3]> = (0..count).map(|_| near(60)).collect();
        add(&mut mesh, region, (0..12).map(|_| near(90)));
        add(&mut mesh, region, placed.iter().copied());
        nodes.extend(placed);
    }
    let ring = [[5010, 0, 0], [4990, 0, 0], [5000, 10, 0], [5000, -10, 0], [5000, 0, 10]];
    add(&mut mesh, 4, ring.into_iter().chain([[5000, 0, 0]]));
    let touching = [[9000, 0, 0], [9001, 0, 0], [9002, 0, 0], [9003, 1, 0], [9000, 1, 0]];
    add(&mut mesh, 5, (0..5).map(|x| [9000 + x, 0, 0]));
    add(&mut mesh, 6, [[12_000, 1, 1], [12_003, 0, 0]].into_iter());
    nodes.extend(ring.into_iter().chain(touching).chain([[12_000, 0, 0]; 5]));
    let motion = |step: u8, noise: &mut Noise| Motion {
        translation: nodes.iter().map(|_| noise.point(900)).collect(),
        turn_or_scale: nodes.iter().map(|_| noise.point(20)).collect(),
        steps: [step, 20 + step],
        ..Motion::default()
    };
    let motions = [1, 2, 3, 5, 6, 7, 9].map(|step| motion(step, &mut noise)).into();
    let header = Text::new(HEADER)
        .set("fraction_bits", 0, "6")
        .set("max_group_length", 0, "8")
        .set("weight_scheme", 0, &scheme.to_string())
        .set("influence_mode", 0, "0")
        .set("label_set", 0, "2")
        .after("grid_step", 0, &["label_count = 7", "label_region = 0 1 2 3 4 5 6"]);
    let sigma = (scheme == 2).then_some(7);
    let scene = Scene { header, mesh, nodes, affine: false, sigma, motions };
    let danger = "Regions of 1, 2, 4 and 5 nodes where 4 move a vertex, nodes all as far, closer than a \
                  step, five in one point; small steps.";
    scene.draft(name, danger, None, FEW_NODES)
}

const FEW_NODES: &[&str] = &[
    "deform.influence.nearest",
    "deform.influence.replication",
    "deform.influence.strict",
    "deform.weights.floor",
    "deform.weights.inverse",
    "deform.weights.sumner",
    "deform.weights.gaussian",
    "deform.weights.normalise",
    "deform.exp",
    "motion.step.translation",
];

fn add(mesh: &mut GridMesh, label: u8, positions: impl Iterator<Item = [i32; 3]>) {
    mesh.positions.extend(positions);
    mesh.labels.resize(mesh.positions.len(), label);
}
