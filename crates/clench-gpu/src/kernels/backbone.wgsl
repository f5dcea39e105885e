// The backbone of a metric. CPU counterparts: `Metric::factor_backbone` in `dynamics/metric.rs`, and
// `Problem::noslip_factor` in `clench-solver/src/problem.rs`. Teams and workgroups share this text.

// Exchanges the matrices or factors in QLD and BACKBONE, and the inverse pivots.
fn exchange_backbone() {
    for (var p = worker(); p < bound(NNZ); p += workers()) {
        let other = fetch(BACKBONE + p);
        put(BACKBONE + p, fetch(QLD + p));
        put(QLD + p, other);
    }
    for (var i = worker(); i < bound(NV); i += workers()) {
        let other = fetch(BACKBONE_INVERSE + i);
        put(BACKBONE_INVERSE + i, fetch(QLD_INVERSE + i));
        put(QLD_INVERSE + i, other);
    }
    join();
}
