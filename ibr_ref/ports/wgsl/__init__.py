"""The methods in WGSL, by wgpu: WebGPU outside a browser, over Vulkan, Metal, Direct3D 12 or OpenGL."""
