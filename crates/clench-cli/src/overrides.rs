//! Flags for the options of the constraint model, one per row of the table of options.

use clap::builder::{PossibleValuesParser, TypedValueParser, ValueParser};
use clap::error::ErrorKind;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, Error, FromArgMatches};
use clench::RigidOptions;
use clench::rigid::options::{Argument, MaxContacts, OptionValue, Range, RigidOption};

/// The heading of these flags in a help text.
pub(crate) const HEADING: &str = "Options that override the file";

/// Options that override the file's `<option>`; options that are not given keep the file's value.
pub(crate) struct Overrides(pub RigidOptions);

impl Args for Overrides {
    fn augment_args(command: Command) -> Command {
        command.args(RigidOption::ALL.iter().map(|&option| flag(option)))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for Overrides {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let mut options = RigidOptions::new();
        for &option in RigidOption::ALL {
            let value = match option.argument() {
                Argument::Value(_) => matches.get_one(option.name()).copied(),
                Argument::Sets(_, value, _) => matches.get_flag(option.name()).then_some(value),
            };
            if let Some(value) = value {
                (options.set(option, value)).map_err(|wrong| {
                    Error::raw(ErrorKind::ValueValidation, format!("{wrong}\n"))
                })?;
            }
        }
        Ok(Overrides(options))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        self.0 = Overrides::from_arg_matches(matches)?.0.or(self.0);
        Ok(())
    }
}

fn flag(option: RigidOption) -> Arg {
    let arg = Arg::new(option.name()).help_heading(HEADING);
    let sentence = option.sentence().trim_end_matches('.');
    match option.argument() {
        Argument::Value(flag) => {
            let default = option.default(false);
            arg.long(flag)
                .value_parser(parser(option))
                .value_name(value_name(default))
                .ignore_case(true)
                .help(sentence)
        }
        Argument::Sets(flag, _, help) => arg.long(flag).action(ArgAction::SetTrue).help(help),
    }
}

fn value_name(default: OptionValue) -> &'static str {
    match default {
        OptionValue::Count(_) | OptionValue::Limit(_) => "N",
        OptionValue::Number(_) => "X",
        _ => "NAME",
    }
}

/// Returns a parser of the values of an option.
fn parser(option: RigidOption) -> ValueParser {
    match option.default(false) {
        OptionValue::Count(_) => (|text: &str| text.parse().map(OptionValue::Count)).into(),
        OptionValue::Number(_) => (move |text: &str| in_range(option.range(), text)).into(),
        OptionValue::Limit(_) => {
            let limit = |n| OptionValue::Limit(MaxContacts::Limit(n));
            (move |text: &str| text.parse().map(limit)).into()
        }
        choices => {
            let spellings = choices.keywords().iter().map(|(name, _)| *name);
            let meaning = move |text: String| {
                let is_same = |(name, _): &&(&str, OptionValue)| name.eq_ignore_ascii_case(&text);
                let found = choices.keywords().iter().find(is_same);
                found.map(|&(_, value)| value).ok_or(choices.description())
            };
            (PossibleValuesParser::new(spellings).try_map(meaning)).into()
        }
    }
}

/// Parses a number and checks its range.
fn in_range(range: Range, text: &str) -> Result<OptionValue, String> {
    let number = text.parse::<f64>().map_err(|error| error.to_string())?;
    let value = OptionValue::Number(number);
    match range.holds(value) {
        true => Ok(value),
        false => Err(format!("it must be {}", range.text())),
    }
}
