"""The networks: the paper's convolutional one, and those that are compared with it."""
