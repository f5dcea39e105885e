// Trees that tendons wake. CPU counterpart: `wake_pulled` in `sleep/wake.rs`.

// Wakes trees by tendons at a limit or with dry friction that connect them to others.
fn wake_pulled() {
    for (var k = 0u; k < NTIE; k++) {
        let tie = TIES + TIE_SIZE * k;
        var pulls = false;
        if (words[tie + TIE_LIMIT] != NONE) {
            let prm = LIMIT_PRM + LIMIT_SIZE * words[tie + TIE_LIMIT];
            let length = fetch(TEN_LENGTH + words[tie + TIE_TENDON]);
            let apart = min(length - parameter(prm + LIMIT_LOW), parameter(prm + LIMIT_HIGH) - length);
            pulls = apart < parameter(prm + LIMIT_MARGIN);
        }
        if (words[tie + TIE_FRICTION] != NONE) {
            let prm = FRICTION_PRM + FRICTION_SIZE * words[tie + TIE_FRICTION];
            pulls = pulls || parameter(prm + FRICTION_LOSS) > 0.0;
        }
        if (pulls) {
            wake_each_other(words[tie + TIE_FIRST], words[tie + TIE_SECOND]);
        }
    }
    update_awake();
}
