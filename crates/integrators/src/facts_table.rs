//! The methods' facts as a table in Markdown: what the documentation prints.

use crate::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, FirstOrderFacts, Method,
    Stability, Symplecticity,
};

/// The facts of every method, one row each, as a table in Markdown.
pub fn facts_table() -> String {
    let mut table = String::from(
        "| method | order | step | stages | symmetric | symplectic | stable on an oscillator \
         | fast decay | energy | error grows | linear momentum | angular momentum |\n",
    );
    table.push_str(&"| --- ".repeat(12));
    table.push_str("|\n");
    for method in Method::ALL {
        table.push_str(&row(&method.facts()));
    }
    table
}

/// The facts of the methods for first-order systems, one row each, as a table in Markdown.
pub fn first_order_facts_table() -> String {
    let mut table = String::from(
        "| method for first-order systems | order | between steps | step | evaluations or stages \
         | more for dense output | tolerance held, at most | fast decay | bounded within |\n",
    );
    table.push_str(&"| --- ".repeat(9));
    table.push_str("|\n");
    for facts in FirstOrderFacts::all() {
        let cells = [
            format!("`{}`", facts.name),
            facts.order.to_string(),
            facts.dense_order.to_string(),
            evaluation(facts.evaluation).into(),
            facts.stages.to_string(),
            facts.dense_stages.to_string(),
            format!("{:e}", facts.loosest),
            damping(facts.damping).into(),
            format!("{}° of decay", facts.sector),
        ];
        table.push_str(&format!("| {} |\n", cells.join(" | ")));
    }
    table
}

fn row(facts: &Facts) -> String {
    let cells = [
        format!("`{}`", facts.name),
        facts.order.to_string(),
        evaluation(facts.evaluation).into(),
        facts.stages.to_string(),
        if facts.symmetric { "yes" } else { "no" }.into(),
        symplecticity(facts.symplecticity).into(),
        stability(facts.stability),
        damping(facts.damping).into(),
        energy(facts.energy).into(),
        error_growth(facts.error_growth).into(),
        conservation(facts.linear_momentum).into(),
        conservation(facts.angular_momentum).into(),
    ];
    format!("| {} |\n", cells.join(" | "))
}

fn evaluation(evaluation: Evaluation) -> &'static str {
    match evaluation {
        Evaluation::Explicit => "explicit",
        Evaluation::Implicit => "implicit",
    }
}

fn symplecticity(symplecticity: Symplecticity) -> &'static str {
    match symplecticity {
        Symplecticity::Symplectic => "yes",
        Symplecticity::Conjugate => "conjugate",
        Symplecticity::No => "no",
    }
}

fn stability(stability: Stability) -> String {
    match stability {
        Stability::Below(limit) => format!("`h omega < {limit:.4}`"),
        Stability::Always => "at every step".into(),
        Stability::Never => "at no step".into(),
    }
}

fn damping(damping: Damping) -> &'static str {
    match damping {
        Damping::Conditional => "blows up",
        Damping::AStable => "stays bounded",
        Damping::LStable => "dies out",
    }
}

fn energy(energy: EnergyBehavior) -> &'static str {
    match energy {
        EnergyBehavior::Bounded => "bounded",
        EnergyBehavior::Grows => "grows",
        EnergyBehavior::Decays => "decays",
    }
}

fn error_growth(growth: ErrorGrowth) -> &'static str {
    match growth {
        ErrorGrowth::Linear => "linearly",
        ErrorGrowth::Exponential => "exponentially",
        ErrorGrowth::Saturates => "until it saturates",
    }
}

fn conservation(conservation: Conservation) -> &'static str {
    match conservation {
        Conservation::Exact => "exact",
        Conservation::LinearForces => "exact for linear forces",
        Conservation::ToOrder => "to order",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `UPDATE_DOCS=1 cargo test` writes the tables anew, and then fails no more.
    #[test]
    fn the_documentation_prints_these_tables() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/src/integrators.md");
        let mut text = std::fs::read_to_string(page).unwrap();
        for table in [facts_table(), first_order_facts_table()] {
            let heading = table.split_once(" | order").expect("a heading").0;
            let start = text.find(&format!("{heading} | order")).expect("a table of facts");
            let end = start + text[start..].find("\n\n").expect("an end of the table") + 1;
            if std::env::var_os("UPDATE_DOCS").is_some() {
                text = [&text[..start], &table, &text[end..]].concat();
                std::fs::write(page, &text).unwrap();
            } else {
                assert_eq!(&text[start..end], table, "run the tests with UPDATE_DOCS=1");
            }
        }
    }
}
