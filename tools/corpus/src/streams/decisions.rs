//! Payloads of chapter 5, decision by decision: what no encoder would write.

use std::collections::HashMap;

use kn_bitstream::range::{BinaryCoder, BitModel, GammaModels, RangeEncoder, code_gamma};

/// A decision of a section, to be coded when all are known.
enum Decision {
    Bit(String, bool),
    Gamma(String, u32),
    Raw(u32, u32),
}

/// The decisions of a section. Models are what their names tell apart.
#[derive(Default)]
pub(crate) struct Decisions(Vec<Decision>);

impl Decisions {
    pub(crate) fn bit(&mut self, model: &str, bit: bool) {
        self.0.push(Decision::Bit(model.into(), bit));
    }

    pub(crate) fn gamma(&mut self, models: &str, value: u32) {
        self.0.push(Decision::Gamma(models.into(), value));
    }

    /// Words: `model=1`, `models~value` of a gamma value, `16:value` of so many raw bits.
    pub(crate) fn script(&mut self, script: &str) {
        let number =
            |text: &str| text.parse::<u32>().unwrap_or_else(|_| panic!("{text}: no number"));
        for word in script.split_whitespace() {
            if let Some((model, bit)) = word.split_once('=') {
                self.bit(model, bit == "1");
            } else if let Some((models, value)) = word.split_once('~') {
                self.gamma(models, number(value));
            } else if let Some((count, value)) = word.split_once(':') {
                self.0.push(Decision::Raw(number(count), number(value)));
            } else {
                panic!("{word}: no decision");
            }
        }
    }

    /// The bytes of the section.
    pub(crate) fn finish(self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut coder = RangeEncoder::new(&mut bytes);
        let mut models: HashMap<String, BitModel> = HashMap::new();
        let mut gammas: HashMap<String, GammaModels> = HashMap::new();
        for decision in self.0 {
            match decision {
                Decision::Bit(name, bit) => {
                    coder.bit(models.entry(name).or_default(), bit);
                }
                Decision::Gamma(name, value) => {
                    code_gamma(&mut coder, gammas.entry(name).or_default(), value);
                }
                Decision::Raw(count, value) => {
                    coder.raw(value, count);
                }
            }
        }
        coder.finish();
        bytes
    }
}

/// A section of the words of [`Decisions::script`].
pub(crate) fn section(script: &str) -> Vec<u8> {
    let mut decisions = Decisions::default();
    decisions.script(script);
    decisions.finish()
}

/// A payload: flags, the six counts of 5.1 and the sections.
pub(crate) fn payload(flags: u8, counts: [u32; 6], sections: [Vec<u8>; 3]) -> Vec<u8> {
    let mut payload = vec![flags, 0];
    let sizes = sections.iter().map(|section| section.len() as u32);
    for mut number in counts.into_iter().chain(sizes) {
        while number >= 128 {
            payload.push(number as u8 | 0x80);
            number >>= 7;
        }
        payload.push(number as u8);
    }
    payload.extend(sections.concat());
    payload
}
