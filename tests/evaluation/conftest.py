from formula_decoders import formula_decoder, gantry, linear_decoder, turning_decoder

__all__ = ["formula_decoder", "gantry", "linear_decoder", "turning_decoder"]
