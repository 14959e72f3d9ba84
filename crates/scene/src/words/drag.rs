//! The word `drag`.

use std::ops::Range;

use toml::Spanned;

use crate::text::check;
use crate::text::diagnostic::Checked;
use crate::text::number::Number;
use crate::words::draft::Draft;
use crate::words::table::{Kind, table};
use crate::words::word::{Of, Word};

table! {
    /// A force that holds back every free particle and the centre of every body, in proportion to its velocity.
    pub(crate) struct DragDeclaration = "a table with a coefficient" {
        /// The force over the velocity.
        coefficient: Spanned<Number> = Kind::Positive,
    }
}

impl Word for Option<DragDeclaration> {
    const OF: Of = Of::Load;

    fn place(&self) -> Option<Range<usize>> {
        self.as_ref().map(|drag| drag.coefficient.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        if let Some(drag) = self {
            draft.drag = Some(check::positive("the coefficient", &drag.coefficient)?);
        }
        Ok(())
    }
}
