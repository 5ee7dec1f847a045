"""Reads triangle meshes from files and places them on the screen: numpy only, no GL."""
