// Forces that the user applies to trees. CPU counterpart: `is_free` in `sleep/wake.rs`.

// Returns true if the user applies no force to a tree.
fn is_free(tree: u32) -> bool {
    for (var i = of_sleeper(tree, SLEEPER_DOF); i < of_sleeper(tree, SLEEPER_DOF_END); i++) {
        if (!is_blank(fetch_state(QFRC_APPLIED + i))) {
            return false;
        }
    }
    for (var k = 6u * of_sleeper(tree, SLEEPER_BODY); k < 6u * of_sleeper(tree, SLEEPER_BODY_END); k++) {
        if (!is_blank(fetch_state(XFRC_APPLIED + k))) {
            return false;
        }
    }
    return true;
}
