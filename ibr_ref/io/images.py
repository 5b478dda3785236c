"""placeholder"""
import imageio.v3 as iio, numpy as np
def write_image(path, image):
    iio.imwrite(path, np.floor(np.clip(image,0,1)*255+.5).astype(np.uint8))
