"""How often an advised error lies inside the 95 % interval of a mean over 400 records.

    python -m experiments.advised [FOLDER] [QUESTIONS] [NAME=VALUE ...]

Draws QUESTIONS questions of the hub study (default 100): natural period, amplitude, rate, delay and
noise of the fixes. Each is asked by `advise`, and the advised scheme is run on 400 records; the
advice has used the first 192 of them. Records have 100 s, so that 100 questions take an hour of two
cores. Further arguments are overrides of all questions.

Writes into FOLDER (default: results/advised) advised.csv: the question, scheme, error, low and high
of the 400 records, and whether the error lies between them.
"""

import numpy as np
import pandas as pd

from experiments.command import read_words, write
from owtsweep.advice.answer import find_answer, measure_closely
from owtsweep.advice.found import find
from owtsweep.advice.question import ask

RECORDS, DURATION = 400, "record.duration=100"
SEED = 41


def draw(generator):
    """Return the overrides of a question."""
    return [
        f"natural_period={generator.uniform(3.0, 8.0):.2f}",
        f"amplitude={np.exp(generator.uniform(np.log(0.05), np.log(10.0))):.3f}",
        f"sensors.gnss.rate={generator.choice([1, 2, 5, 10])}",
        f"sensors.gnss.delay={generator.choice([0.1, 0.2, 0.4])}",
        f"sensors.gnss.sigma={generator.choice([0.01, 0.03, 0.1])}",
    ]


def judge(words, overrides):
    """Ask one question; return its row."""
    question = ask([*words, DURATION, *overrides])
    answer = find_answer(question)
    told = measure_closely(question, answer) or answer.error
    names = [f"schemes=[{answer.best}]", "baselines=[]"]
    if answer.best in answer.found.contents.baselines:
        names = ["schemes=[MKF]", f"baselines=[{answer.best}]"]
    config = question.change(*names, f"grid.replicates={RECORDS}")
    mean = find(question.study, config).measure(answer.best)
    inside = mean.low <= told.value <= mean.high
    return {
        **{name: float(value) for name, _, value in (word.partition("=") for word in words)},
        "scheme": answer.best, "error": told.value, "low": mean.low, "high": mean.high,
        "inside": inside,
    }  # fmt: skip


def main():
    """Ask all questions; write the table and print the count."""
    folder, questions, overrides = read_words("results/advised", 100)
    generator = np.random.default_rng(SEED)
    rows = []
    for number in range(questions):
        row = judge(draw(generator), overrides)
        rows.append(row)
        print(f"{number + 1}: {row}", flush=True)
    table = pd.DataFrame(rows)
    print(f"{table['inside'].sum()} of {len(table)} inside")
    write(folder, {"advised": table})


if __name__ == "__main__":
    main()
