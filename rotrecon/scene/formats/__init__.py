"""Foreign files turned into arrays, one small module a format; every failure is a SceneError."""
