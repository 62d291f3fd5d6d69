//! The components of affine nodes.

use crate::params::NameError;
use std::fmt;
use std::str::FromStr;

/// The components of A = R·S·H that affine nodes carry in a P-frame, beside their translation.
///
/// The bi-modal paper's eight combinations are T, RT, TS, TH, RTS, RTH, TSH and RTSH. A component
/// that is not carried is the identity. Rigid nodes carry rotation and translation whatever the
/// combination. The default is T.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Combination {
    /// R: three Euler angles.
    pub rotation: bool,
    /// S: three factors.
    pub scale: bool,
    /// H: three shears.
    pub shear: bool,
}

impl Combination {
    /// All eight, by rising number of components: T, RT, TS, TH, RTS, RTH, TSH, RTSH.
    pub const ALL: [Self; 8] = [
        Self::new(false, false, false),
        Self::new(true, false, false),
        Self::new(false, true, false),
        Self::new(false, false, true),
        Self::new(true, true, false),
        Self::new(true, false, true),
        Self::new(false, true, true),
        Self::new(true, true, true),
    ];
    /// Rotation and translation: what rigid nodes carry.
    pub const RT: Self = Self::new(true, false, false);
    /// All components.
    pub const RTSH: Self = Self::new(true, true, true);

    /// A combination from its components.
    pub const fn new(rotation: bool, scale: bool, shear: bool) -> Self {
        Self { rotation, scale, shear }
    }

    /// The paper's name, such as `RTS`.
    pub const fn name(self) -> &'static str {
        match (self.rotation, self.scale, self.shear) {
            (false, false, false) => "T",
            (true, false, false) => "RT",
            (false, true, false) => "TS",
            (false, false, true) => "TH",
            (true, true, false) => "RTS",
            (true, false, true) => "RTH",
            (false, true, true) => "TSH",
            (true, true, true) => "RTSH",
        }
    }
}

impl fmt::Display for Combination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Combination {
    type Err = NameError;

    fn from_str(text: &str) -> Result<Self, NameError> {
        let found = Self::ALL.into_iter().find(|combination| combination.name() == text);
        found.ok_or_else(|| NameError::new("combination", text, Self::ALL.map(Self::name)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn combinations_are_read_back_from_their_names() {
        for combination in Combination::ALL {
            assert_eq!(combination.to_string().parse(), Ok(combination));
        }
        let error = "RSH".parse::<Combination>().expect_err("no name");
        assert!(error.to_string().ends_with("T, RT, TS, TH, RTS, RTH, TSH, RTSH"), "{error}");
    }
}
