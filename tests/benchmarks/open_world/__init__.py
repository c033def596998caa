"""Open world: whether the estimator is right, or says that it is not sure, one step outside its own world.

    python -m tests.benchmarks.open_world LINE [N] [--seed S]

Each line is one promise, measured on boards drawn from the seed and the board's number: the same seed gives the same
figures. Beside each figure stand how many it was taken of, its 95 % interval, the goal, and the boards against it.

In the order of reading: ``figures``, what a figure is; ``things`` and ``boards``, what is drawn; ``judging``, what is
right and what is sure and wrong; then the lines: ``ordinary``, ``unknown``, ``crowded``, ``account``, ``speed``,
``simple``. Not here: whether stated deviations are true (``calibration``).
"""
