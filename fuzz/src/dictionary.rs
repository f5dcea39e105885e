//! The dictionary of MJCF for the fuzzer.

use clench::formats::supported;

/// Returns the elements and attributes of MJCF as they appear in a file, one per line, in libFuzzer's format.
pub fn dictionary() -> String {
    let mut words: Vec<String> = Vec::new();
    for support in supported() {
        let tags = support.children.iter();
        words.extend(tags.flat_map(|tag| [format!("<{tag}"), format!("</{tag}>")]));
        for attribute in [support.read, support.ignored, support.refused].concat() {
            let (name, value) = attribute.split_once('=').unwrap_or((attribute, ""));
            words.push(format!(" {name}='{value}"));
        }
    }
    words.sort_unstable();
    words.dedup();
    (words.iter().map(|word| format!("\"{word}\"\n"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dictionary_has_elements_and_attributes_as_they_are_written() {
        let dictionary = dictionary();
        for word in [
            "\"<joint\"",
            "\"</worldbody>\"",
            "\" condim='\"",
            "\" springyield='\"",
            "\" ipc='disable\"",
        ] {
            assert!(dictionary.lines().any(|line| line == word), "{word}");
        }
    }
}
