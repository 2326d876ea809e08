//! Temporary driver.
#![allow(missing_docs, clippy::all)]
#[path = "physics/assembly.rs"]
mod assembly;
use assembly::*;
use std::sync::Mutex;
#[test]
fn sweep() {
    let env = |k: &str, d: u64| std::env::var(k).ok().and_then(|s| s.parse().ok()).unwrap_or(d);
    let seeds = env("SEEDS", 10);
    let ticks = env("TICKS", 1200) as u32;
    let only = std::env::var("ONLY").unwrap_or_default();
    let verbose = env("V", 0);
    let mut cases = vec![];
    for mix in MIXES {
        for shape in SHAPES {
            for start in STARTS {
                for seed in 0..seeds {
                    let c = Case { shape, mix, start, seed };
                    let name = format!("{mix:?} {shape:?} {start:?} {seed}");
                    let neg = std::env::var("NOT").unwrap_or("zzz".into());
                    if name.contains(&neg) {
                        continue;
                    }
                    if only.split(',').all(|o| name.contains(o)) {
                        cases.push((name, c));
                    }
                }
            }
        }
    }
    let out = Mutex::new(vec![]);
    let it = Mutex::new(cases.into_iter());
    std::thread::scope(|s| {
        for _ in 0..2 {
            s.spawn(|| {
                loop {
                    let Some((name, c)) = it.lock().unwrap().next() else { break };
                    let o = c.run(ticks);
                    out.lock().unwrap().push((name, c, o));
                }
            });
        }
    });
    let mut out = out.into_inner().unwrap();
    out.sort_by(|a, b| a.2.gain.total_cmp(&b.2.gain));
    println!(
        "{:24} {:>5} {:>5} {:>5} {:>5} {:>9} {:>7}",
        "cell", "n", ">1%", ">50%", "fault", "worst", "gap p90"
    );
    let mut tot = [0; 4];
    for mix in MIXES {
        for shape in SHAPES {
            let v: Vec<_> = out.iter().filter(|x| x.1.mix == mix && x.1.shape == shape).collect();
            if v.is_empty() {
                continue;
            }
            let f = |g: f64| v.iter().filter(|x| x.2.gain > g).count();
            let faults = v.iter().filter(|x| x.2.faults > 0).count();
            let mut gaps: Vec<f64> = v.iter().map(|x| x.2.gap).collect();
            gaps.sort_by(f64::total_cmp);
            tot[0] += v.len();
            tot[1] += f(0.01);
            tot[2] += f(0.5);
            tot[3] += faults;
            println!(
                "{:24} {:5} {:5} {:5} {:5} {:9.3} {:7.4} max {:7.4}",
                format!("{mix:?} {shape:?}"),
                v.len(),
                f(0.01),
                f(0.5),
                faults,
                v.last().unwrap().2.gain,
                gaps[gaps.len() * 9 / 10],
                gaps.last().unwrap()
            );
        }
    }
    println!("total {} >1% {} >50% {} faults {}", tot[0], tot[1], tot[2], tot[3]);
    if verbose > 0 {
        for (name, _, o) in out.iter().rev().take(verbose as usize) {
            println!("{name}: {o:?}");
        }
    }
}
#[test]
fn one() {
    let Ok(name) = std::env::var("CASE") else { return };
    for mix in MIXES {
        for shape in SHAPES {
            for start in STARTS {
                for seed in 0..200 {
                    let c = Case { shape, mix, start, seed };
                    if format!("{mix:?} {shape:?} {start:?} {seed}") != name {
                        continue;
                    }
                    let mut a = c.build();
                    let e0 = a.energy();
                    for (_, b) in a.world.bodies() {
                        println!("body m {} k {} at {:?}", b.mass(), b.radius_of_gyration(), b.position());
                    }
                    for (_, j) in a.world.joints() {
                        println!(
                            "{:?}-{:?} {:?} {:?} {:?}",
                            j.def().bodies().0.index(),
                            j.def().bodies().1.index(),
                            j.def().kind,
                            j.def().frame_a.anchor,
                            j.def().frame_b.anchor
                        );
                    }
                    let (mut last, mut n) = (e0, 0);
                    for t in 0..1200 {
                        a.world.step();
                        let e = a.energy();
                        if t < 5 || (e - last).abs() > e0.abs() * 0.2 {
                            println!("{t}: {e} gap {} faults {}", a.gap(), a.world.faults());
                            last = e;
                            n += 1;
                            if n > 25 {
                                break;
                            }
                        }
                    }
                }
            }
        }
    }
}
