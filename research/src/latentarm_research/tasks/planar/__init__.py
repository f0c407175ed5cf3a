"""The four planar tasks of the paper's first simulation (section 8.1), each with its demonstrator."""
