"""From a measurement to the disorder in the wire (`infer`), and back to measurements (`verify`).

`invert` finds the optima of the posterior and samples of it, and `verdict` judges them. The
packages below are the steps: `problem`, `search`, `posterior`, `verification`.
"""
