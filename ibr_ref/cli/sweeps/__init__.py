"""`ibr-ref sweep`: a command for each method. What they share is in `shared`; each says which scene is swept over."""
