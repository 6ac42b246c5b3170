"""Our own CC0 models: geometry, procedural materials, baking and glTF export, one file a model."""
