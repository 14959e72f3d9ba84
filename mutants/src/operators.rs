//! The mistakes: every place of a file where one can be planted, and what is written there.
//!
//! | kind | written | planted |
//! | --- | --- | --- |
//! | arithmetic | `+` `-` `*` `/` `%` | `-` `*`, `+` `/`, `/` `+`, `*` `-`, `/` |
//! | compound assignment | `+=` `-=` `*=` `/=` | `-=`, `+=`, `/=`, `*=` |
//! | comparison | `<` `<=` `>` `>=` `==` `!=` | the border moved, the direction turned |
//! | logic | `&&` `\|\|` `!x` `-x` | `\|\|` `&&` `x` `x` |
//! | condition | `if f(x)` | `if !f(x)` |
//! | literal | `0.5`, `3`, `true` | `0.5 + 1.0`, `3 + 1`, `false` |
//! | result | a function's `bool`, `Option`, `Result<(), _>` | `true` and `false`, `None`, `Ok(())` |
//! | statement | `x.f(y);` `f(x)?;` `a += b;` `a = b;` | nothing |
//!
//! What must be constant is left alone, and so are patterns, types, attributes and macros.

use std::ops::Range;

use proc_macro2::TokenStream;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{BinOp, Block, Expr, Lit, Pat, ReturnType, Signature, Stmt, Type, UnOp};

use crate::sources::{Source, counts};

/// How the mutant and the original stand side by side.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// `(if on { mutated } else { original })`
    Expression,
    /// `if on { mutated } else { original }`
    Statement,
    /// `if on { return mutated; }` where a body begins.
    Entry,
}

/// One mistake.
#[derive(Clone)]
pub struct Mutant {
    /// The file, by its place in the list of sources.
    pub file: usize,
    /// The bytes that it replaces.
    pub range: Range<usize>,
    /// What is written instead.
    pub mutated: String,
    /// How it is switched.
    pub form: Form,
    /// For the table.
    pub change: String,
}

/// All mutants of a file, in the order of its text.
pub fn mutants(file: usize, source: &Source) -> Vec<Mutant> {
    let mut finder = Finder { file, text: &source.text, found: Vec::new() };
    finder.visit_file(&source.tree);
    finder.found
}

struct Finder<'a> {
    file: usize,
    text: &'a str,
    found: Vec<Mutant>,
}

fn bytes(node: &impl Spanned) -> Range<usize> {
    node.span().byte_range()
}

impl Finder<'_> {
    fn text(&self, node: &impl Spanned) -> &str {
        &self.text[bytes(node)]
    }

    fn add(&mut self, range: Range<usize>, mutated: String, form: Form, change: String) {
        self.found.push(Mutant { file: self.file, range, mutated, form, change });
    }

    fn replace(&mut self, node: &impl Spanned, mutated: String) {
        let change = format!("{} -> {}", one_line(self.text(node)), one_line(&mutated));
        self.add(bytes(node), mutated, Form::Expression, change);
    }

    fn binary(&mut self, binary: &syn::ExprBinary) {
        let written = self.text(&binary.op).to_string();
        let (left, right) = (self.text(&binary.left), self.text(&binary.right));
        let (left, right) = (left.to_string(), right.to_string());
        for &planted in instead(&binary.op) {
            let mutated = if is_compound(&binary.op) {
                format!("{left} {planted} {right}")
            } else {
                format!("({left}) {planted} ({right})")
            };
            let change = format!("{} -> {planted}", one_line(&format!("{left} {written} {right}")));
            self.add(bytes(binary), mutated, Form::Expression, change);
        }
    }

    fn condition(&mut self, condition: &Expr) {
        if matches!(condition, Expr::MethodCall(_) | Expr::Call(_) | Expr::Path(_) | Expr::Field(_))
        {
            self.replace(condition, format!("!({})", self.text(condition)));
        }
    }

    fn literal(&mut self, literal: &syn::ExprLit) {
        let text = self.text(literal).to_string();
        match &literal.lit {
            Lit::Int(_) => self.replace(literal, format!("{text} + 1")),
            Lit::Float(_) => self.replace(literal, format!("{text} + 1.0")),
            Lit::Bool(value) => self.replace(literal, format!("{}", !value.value)),
            _ => {}
        }
    }

    fn result(&mut self, signature: &Signature, body: &Block) {
        let ReturnType::Type(_, result) = &signature.output else { return };
        let written: String = self.text(&**result).split_whitespace().collect();
        let planted: &[&str] = match written.as_str() {
            "bool" => &["true", "false"],
            result if result.starts_with("Option<") => &["None"],
            result if result.starts_with("Result<(),") => &["Ok(())"],
            _ => &[],
        };
        let begin = body.brace_token.span.open().byte_range().end;
        for planted in planted {
            let change = format!("fn {} -> {planted}", signature.ident);
            self.add(begin..begin, planted.to_string(), Form::Entry, change);
        }
    }
}

/// What is planted for an operator.
fn instead(operator: &BinOp) -> &'static [&'static str] {
    match operator {
        BinOp::Add(_) => &["-", "*"],
        BinOp::Sub(_) => &["+", "/"],
        BinOp::Mul(_) => &["/", "+"],
        BinOp::Div(_) => &["*", "-"],
        BinOp::Rem(_) => &["/"],
        BinOp::AddAssign(_) => &["-="],
        BinOp::SubAssign(_) => &["+="],
        BinOp::MulAssign(_) => &["/="],
        BinOp::DivAssign(_) => &["*="],
        BinOp::Lt(_) => &["<=", ">"],
        BinOp::Le(_) => &["<", ">"],
        BinOp::Gt(_) => &[">=", "<"],
        BinOp::Ge(_) => &[">", "<"],
        BinOp::Eq(_) => &["!="],
        BinOp::Ne(_) => &["=="],
        BinOp::And(_) => &["||"],
        BinOp::Or(_) => &["&&"],
        BinOp::BitAnd(_) => &["|"],
        BinOp::BitOr(_) => &["&"],
        BinOp::Shl(_) => &[">>"],
        BinOp::Shr(_) => &["<<"],
        _ => &[],
    }
}

fn is_compound(operator: &BinOp) -> bool {
    matches!(
        operator,
        BinOp::AddAssign(_) | BinOp::SubAssign(_) | BinOp::MulAssign(_) | BinOp::DivAssign(_)
    )
}

/// Whether `if let` stands in a chain of conditions, which is no expression of its own.
fn binds(expression: &Expr) -> bool {
    match expression {
        Expr::Let(_) => true,
        Expr::Binary(binary) => binds(&binary.left) || binds(&binary.right),
        _ => false,
    }
}

/// Shortened for a table.
fn one_line(text: &str) -> String {
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match words.char_indices().nth(48) {
        Some((end, _)) => format!("{}…", &words[..end]),
        None => words,
    }
}

impl<'ast> Visit<'ast> for Finder<'_> {
    fn visit_expr(&mut self, expression: &'ast Expr) {
        match expression {
            Expr::Binary(binary) if !binds(expression) => self.binary(binary),
            Expr::Unary(unary) if matches!(unary.op, UnOp::Neg(_) | UnOp::Not(_)) => {
                self.replace(unary, self.text(&*unary.expr).to_string());
            }
            Expr::If(choice) => self.condition(&choice.cond),
            Expr::While(repeated) => self.condition(&repeated.cond),
            Expr::Lit(literal) => self.literal(literal),
            Expr::Repeat(repeat) => return self.visit_expr(&repeat.expr),
            Expr::Const(_) => return,
            _ => {}
        }
        visit::visit_expr(self, expression);
    }

    fn visit_stmt(&mut self, statement: &'ast Stmt) {
        let attributes = match statement {
            Stmt::Local(local) => &local.attrs,
            Stmt::Expr(Expr::Block(block), _) => &block.attrs,
            _ => &Vec::new(),
        };
        if !counts(attributes) {
            return;
        }
        if let Stmt::Expr(expression, Some(_)) = statement {
            let acts = match expression {
                Expr::MethodCall(_) | Expr::Call(_) | Expr::Try(_) | Expr::Assign(_) => true,
                Expr::Binary(binary) => is_compound(&binary.op),
                _ => false,
            };
            if acts {
                let change = format!("{} dropped", one_line(self.text(statement)));
                self.add(bytes(statement), String::new(), Form::Statement, change);
            }
        }
        visit::visit_stmt(self, statement);
    }

    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        if counts(&function.attrs) && function.sig.constness.is_none() {
            self.result(&function.sig, &function.block);
            visit::visit_item_fn(self, function);
        }
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if counts(&function.attrs) && function.sig.constness.is_none() {
            self.result(&function.sig, &function.block);
            visit::visit_impl_item_fn(self, function);
        }
    }

    fn visit_trait_item_fn(&mut self, function: &'ast syn::TraitItemFn) {
        if let Some(body) = &function.default {
            self.result(&function.sig, body);
            visit::visit_trait_item_fn(self, function);
        }
    }

    fn visit_item_mod(&mut self, module: &'ast syn::ItemMod) {
        if counts(&module.attrs) {
            visit::visit_item_mod(self, module);
        }
    }

    fn visit_item_impl(&mut self, block: &'ast syn::ItemImpl) {
        if counts(&block.attrs) {
            visit::visit_item_impl(self, block);
        }
    }

    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_trait_item_const(&mut self, _: &'ast syn::TraitItemConst) {}
    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}
    fn visit_variant(&mut self, _: &'ast syn::Variant) {}
    fn visit_pat(&mut self, _: &'ast Pat) {}
    fn visit_type(&mut self, _: &'ast Type) {}
    fn visit_generics(&mut self, _: &'ast syn::Generics) {}
    fn visit_generic_argument(&mut self, _: &'ast syn::GenericArgument) {}
    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}
    fn visit_macro(&mut self, _: &'ast syn::Macro) {}
    fn visit_token_stream(&mut self, _: &'ast TokenStream) {}
}
