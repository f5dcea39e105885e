//! Base64 encoding (RFC 4648), as used by glTF files and viewer pages.

const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Encodes three bytes as four letters each; `=` pads the last group.
pub fn encode(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(4 * bytes.len().div_ceil(3));
    for three in bytes.chunks(3) {
        let mut word = [0; 4];
        word[1..=three.len()].copy_from_slice(three);
        let word = u32::from_be_bytes(word);
        for k in 0..4 {
            let letter = LETTERS[(word >> (18 - 6 * k)) as usize % LETTERS.len()];
            text.push(if k <= three.len() { letter.into() } else { '=' });
        }
    }
    text
}

/// Decodes canonical, padded base64.
///
/// # Errors
/// Returns a message if the text is invalid.
pub fn decode(text: &str) -> Result<Vec<u8>, String> {
    if !text.len().is_multiple_of(4) {
        return Err(format!("{} characters are not a multiple of 4", text.len()));
    }
    let ends = ["==", "="];
    let stripped = ends.iter().find_map(|end| text.strip_suffix(end));
    let letters = stripped.unwrap_or(text).as_bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    for (index, four) in letters.chunks(4).enumerate() {
        let mut word = 0;
        for (k, &letter) in four.iter().enumerate() {
            let value = value(letter);
            let value = value.ok_or_else(|| format!("character {} is invalid", 4 * index + k))?;
            word |= u32::from(value) << (18 - 6 * k);
        }
        let [_, three @ ..] = word.to_be_bytes();
        let (whole, rest) = three.split_at(four.len() - 1);
        if rest.iter().any(|&byte| byte != 0) {
            return Err("the last byte is incomplete".to_owned());
        }
        bytes.extend_from_slice(whole);
    }
    Ok(bytes)
}

/// Returns the value of a letter.
fn value(letter: u8) -> Option<u8> {
    Some(match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_the_standard_are_met() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(encode(bytes.as_bytes()), text);
            assert_eq!(decode(text).unwrap(), bytes.as_bytes());
        }
        let all: Vec<u8> = (0..=255).collect();
        assert_eq!(decode(&encode(&all)).unwrap(), all);
    }

    #[test]
    fn invalid_base64_is_refused() {
        for (text, complaint) in [
            ("Zg", "2 characters"),
            ("Zg=", "3 characters"),
            ("Zh==", "last byte"),
            ("Z===", "character 1 "),
            ("====", "character 0 "),
            ("Zm=v", "character 2 "),
            ("Zm9v\n\n\n\n", "character 4 "),
            ("Zm9é", "5 characters"),
            ("Zmé", "character 2 "),
        ] {
            let error = decode(text).expect_err(text);
            assert!(error.contains(complaint), "{text}: {error}");
        }
    }
}
