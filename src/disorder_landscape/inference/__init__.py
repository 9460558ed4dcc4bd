"""From a measurement to the disorder in the wire (`infer`), and back to measurements (`verify`).

`invert` makes attempts at explaining a measurement, and `verdict` judges them. The packages below
are the steps: `problem`, `search`, `posterior`, `verification`.
"""
