"""The methods in WebGL 2, on a page that a browser runs: JavaScript that reads the exported case and writes .npy files."""
