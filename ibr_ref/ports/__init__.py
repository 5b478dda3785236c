"""Sample ports: the three methods as their users write them, drawn from exported case folders alone.

`ibr-ref draw CASE OUT --with glsl | wgsl | webgl | plain` draws cases: GLSL on headless OpenGL, WGSL by wgpu, WebGL 2 on a
page in a headless browser, and NumPy. Nothing here, but `described` and `drawing`, imports anything else of the package: a
port in another language has the folder alone. Readers of .npy: `webgl/npy.js`, `cpp/npy.hpp`.
"""
