"""The paper's third simulation (section 8.3): learning what people mean by their input."""
