//! Range, rig and pose of a pair, from a file that is named or lies beside its images.

use linestereo_frames::{PairFiles, RigText, SceneInfo};
use std::path::{Path, PathBuf};

/// Knowledge of a pair besides its images.
#[derive(Clone, Debug, Default)]
pub(super) enum Known {
    #[default]
    Nothing,
    /// It is rectified; the file that says what else is known.
    Scene(PathBuf, SceneInfo),
    /// A scene.json that nobody named lies beside the images: what it says, or why it is none.
    Beside(PathBuf, Result<SceneInfo, String>),
    /// It is raw; its rig.
    Raw(Vec<RigText>),
}

impl Known {
    /// Pairs of both are matched with the same.
    pub(super) fn matches_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Nothing, Self::Nothing) => true,
            (Self::Scene(_, info), Self::Scene(_, other))
            | (Self::Beside(_, Ok(info)), Self::Beside(_, Ok(other))) => info.matches_like(other),
            (Self::Raw(files), Self::Raw(others)) => files == others,
            _ => false,
        }
    }
}

/// The scene.json in the folder of both images of a pair that stands alone.
pub(super) fn beside(images: &PairFiles) -> Option<PathBuf> {
    let [left, right] = match images {
        PairFiles::Two(_) | PairFiles::SideBySide(_) => images.paths().map(Path::parent),
        PairFiles::Source(_) => return None,
    };
    let path = left.filter(|_| left == right)?.join("scene.json");
    path.is_file().then_some(path)
}
