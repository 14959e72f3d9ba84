//! The word `frame`: everything is seen in a frame that turns about the origin.

use std::ops::Range;

use crate::text::diagnostic::Checked;
use crate::text::turn::Turn;
use crate::words::draft::Draft;
use crate::words::table::{Kind, table};
use crate::words::word::{Of, Word};

table! {
    /// A frame that turns about the origin, in which all places, orientations and velocities are seen.
    pub(crate) struct FrameDeclaration = "a table with an angular velocity" {
        /// That of the frame.
        angular_velocity: Turn = Kind::Turn,
    }
}

impl Word for Option<FrameDeclaration> {
    const OF: Of = Of::Load;

    fn place(&self) -> Option<Range<usize>> {
        self.as_ref().map(|frame| frame.angular_velocity.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        let Some(FrameDeclaration { angular_velocity }) = self else { return Ok(()) };
        let turning = angular_velocity.components("the angular velocity", draft.dimension)?;
        draft.frame = Some(turning);
        Ok(())
    }
}
