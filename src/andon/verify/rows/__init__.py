"""The rows, one module a stage; what they measure stands beside them."""
