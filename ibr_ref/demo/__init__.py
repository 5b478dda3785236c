"""The pictures of `ibr-ref demo`: figures of the papers, from built-in inputs."""
